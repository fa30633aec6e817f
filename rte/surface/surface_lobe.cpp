// The lobe of a rough surface, and what it lets through to the layers below.
#include <algorithm>
#include <cmath>
#include <numbers>

#include <miebrdf/error.h>
#include <miebrdf/surface.h>
#include "rte/surface/fresnel.h"
#include "rte/surface/microfacet.h"

namespace miebrdf::rte {
namespace {

void check_cosine(double mu, const char* field) {
    if (!(mu > 0 && mu <= 1)) throw UsageError(field, mu, "(0, 1]");
}

/// The square of the horizontal part of (towards source) + (towards viewer). The sines are
/// subtracted through the cosines and 1 - cos(azimuth) is 2 sin^2: close to the mirror direction,
/// where a smooth surface has its peak, nothing cancels.
double horizontal_sum2(double mu_in, double mu_out, double azimuth_deg) {
    const double sin_in = std::sqrt((1.0 - mu_in) * (1.0 + mu_in));
    const double sin_out = std::sqrt((1.0 - mu_out) * (1.0 + mu_out));
    const double sum = sin_in + sin_out;
    const double difference = sum > 0 ? (mu_out - mu_in) * (mu_out + mu_in) / sum : 0.0;
    const double half = std::sin(azimuth_deg * std::numbers::pi / 360.0);
    return difference * difference + 4.0 * sin_in * sin_out * half * half;
}

}  // namespace

struct SurfaceLobe::Model {
    std::complex<double> refractive_index;
    SurfaceOptions options;
    FresnelReflectance fresnel;
    ShadowingOverCosines shadowing;
};

SurfaceLobe::SurfaceLobe(std::complex<double> refractive_index, const SurfaceOptions& options)
    : model_(std::make_shared<const Model>(
          Model{refractive_index, options, FresnelReflectance(refractive_index, options.fresnel),
                ShadowingOverCosines(options)})) {}

std::complex<double> SurfaceLobe::refractive_index() const { return model_->refractive_index; }
const SurfaceOptions& SurfaceLobe::options() const { return model_->options; }

double SurfaceLobe::brdf(double mu_in, double mu_out, double azimuth_deg) const {
    check_cosine(mu_in, "mu_in");
    check_cosine(mu_out, "mu_out");
    if (!std::isfinite(azimuth_deg)) {
        throw UsageError("azimuth_deg", azimuth_deg, "any finite number");
    }
    const double horizontal2 = horizontal_sum2(mu_in, mu_out, azimuth_deg);
    const double vertical = mu_in + mu_out;
    const double length = std::sqrt(horizontal2 + vertical * vertical);
    const FacetGeometry facet{mu_in, mu_out, vertical / length, std::min(1.0, 0.5 * length)};
    const double density =
        normal_density(model_->options.distribution, model_->options.beckmann_alpha,
                       horizontal2 / (vertical * vertical));
    // A density that has underflowed stays 0, however large the other factors are.
    return density == 0
               ? 0.0
               : 0.25 * density * model_->shadowing(facet) * model_->fresnel(facet.cos_facet);
}

double SurfaceLobe::directional_reflectance(double mu_in) const {
    return rte::directional_reflectance(refractive_index(), options(), mu_in).value;
}

double SurfaceLobe::averaged_diffuse_reflectance_factor() const {
    return mean_transmittance([this](double mu) { return directional_reflectance(mu); },
                              HemisphereMean::solid_angle)
        .value;
}

SurfaceTransmission::SurfaceTransmission(const SurfaceLobe& lobe, SurfaceCoupling coupling)
    : lobe_(lobe), coupling_(coupling) {
    if (coupling_ == SurfaceCoupling::reciprocal) {
        const auto rho = [this](double mu) { return lobe_.directional_reflectance(mu); };
        mean_transmittance_ = rte::mean_transmittance(rho, HemisphereMean::cosine).value;
    }
}

double SurfaceTransmission::in(double mu) const { return 1.0 - lobe_.directional_reflectance(mu); }

double SurfaceTransmission::out(double mu) const {
    return coupling_ == SurfaceCoupling::paper ? 1.0 : in(mu) / mean_transmittance_;
}

SurfaceWeights SurfaceTransmission::weights(double mu) const {
    const double let_in = in(mu);
    return {let_in, coupling_ == SurfaceCoupling::paper ? 1.0 : let_in / mean_transmittance_};
}

}  // namespace miebrdf::rte
