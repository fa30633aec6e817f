#include "rte/surface/layered_brdf.h"

#include <numbers>

#include "rte/surface/diffuse_reflectance.h"

namespace miebrdf::rte {

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

BoundaryWeights SurfaceTransmission::weights(double mu) const {
    const double let_in = in(mu);
    return {let_in, coupling_ == SurfaceCoupling::paper ? 1.0 : let_in / mean_transmittance_};
}

double complete_brdf(const SurfaceLobe& lobe, const SurfaceTransmission& transmission, double mu_in,
                     double mu_out, double azimuth_deg, double reflection) {
    return lobe.brdf(mu_in, mu_out, azimuth_deg) +
           transmission.in(mu_in)*transmission.out(mu_out) * reflection / std::numbers::pi;
}

}  // namespace miebrdf::rte
