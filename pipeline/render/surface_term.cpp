#include "pipeline/render/surface_term.h"

#include <cmath>

#include "pipeline/render/cubic_taps.h"
#include "pipeline/render/half_vector.h"

namespace miebrdf::render {
namespace {

constexpr std::size_t kNodes = 64;
/// sqrt(mu) of the first node; rho is asked for at positive cosines only, and levels off there.
constexpr double kFirst = 0.01;

double node(std::size_t i) { return kFirst + (1.0 - kFirst) * double(i) / (kNodes - 1); }

CubicTaps taps_of(double mu) {
    return uniform_taps((std::sqrt(mu) - kFirst) / (1.0 - kFirst) * (kNodes - 1), kNodes);
}

}  // namespace

SurfaceTerm::SurfaceTerm(const std::vector<std::complex<double>>& refractive_index,
                         const rte::SurfaceOptions& options, rte::SurfaceCoupling coupling)
    : options_(options), shadowing_(options), in_(kNodes * refractive_index.size()),
      out_(in_.size()) {
    const std::size_t count = refractive_index.size();
    for (std::size_t w = 0; w < count; ++w) {
        fresnel_.emplace_back(refractive_index[w], options.fresnel);
        const rte::SurfaceTransmission transmission({refractive_index[w], options}, coupling);
        for (std::size_t i = 0; i < kNodes; ++i) {
            const double mu = i + 1 == kNodes ? 1.0 : node(i) * node(i);
            in_[i * count + w] = transmission.in(mu);
            out_[i * count + w] = transmission.out(mu);
        }
    }
}

void SurfaceTerm::weaken(double mu_in, double mu_out, std::span<double> brdf) const {
    const CubicTaps in = taps_of(mu_in), out = taps_of(mu_out);
    const std::size_t count = brdf.size();
    for (std::size_t w = 0; w < count; ++w) {
        double factor_in = 0.0, factor_out = 0.0;
        for (std::size_t k = 0; k < 4; ++k) {
            factor_in += in.weight[k] * in_[(in.first + k) * count + w];
            factor_out += out.weight[k] * out_[(out.first + k) * count + w];
        }
        brdf[w] *= factor_in * factor_out;
    }
}

void SurfaceTerm::add(double mu_in, double mu_out, double cos_azimuth, std::span<double> brdf) const {
    const HalfVector half = half_vector(mu_in, mu_out, cos_azimuth);
    const double cos2 = half.cos_normal * half.cos_normal;
    const double tan2 = (1.0 - half.cos_normal) * (1.0 + half.cos_normal) / cos2;
    const double shape =
        0.25 * rte::normal_density(options_.distribution, options_.beckmann_alpha, tan2) *
        shadowing_({mu_in, mu_out, half.cos_normal, half.cos_light});
    for (std::size_t w = 0; w < brdf.size(); ++w) brdf[w] += shape * fresnel_[w](half.cos_light);
}

}  // namespace miebrdf::render
