#include "rte/surface/microfacet.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace miebrdf::rte {

using std::numbers::inv_sqrtpi;
using std::numbers::pi;

void validate(const SurfaceOptions& options) {
    if (!(options.beckmann_alpha >= 1e-4 && options.beckmann_alpha <= 4.0)) {
        throw std::invalid_argument(
            fmt::format("surface roughness {}; allowed: 0.0001 to 4 (Beckmann slope parameter)",
                        options.beckmann_alpha));
    }
}

double normal_density(MicrofacetDistribution distribution, double alpha, double tan2_half) {
    const double tan2 = std::min(tan2_half, 1e100);  // keeps sec^4 finite; D is at its limit there
    const double t = tan2 / (alpha * alpha);
    const double sec2 = 1.0 + tan2;
    const double profile = distribution == MicrofacetDistribution::beckmann
                               ? std::exp(-t)
                               : 1.0 / ((1.0 + t) * (1.0 + t));
    return profile * sec2 * sec2 / (pi * alpha * alpha);
}

double cosine_over_masking(MicrofacetDistribution distribution, double alpha, double mu) {
    const double sine = std::sqrt(std::max(0.0, (1.0 - mu) * (1.0 + mu)));
    const double spread = alpha * sine;
    if (distribution == MicrofacetDistribution::ggx) return 0.5 * (mu + std::hypot(mu, spread));
    if (spread == 0.0) return mu;
    const double a = mu / spread;
    return mu + 0.5 * (spread * std::exp(-a * a) * inv_sqrtpi - mu * std::erfc(a));
}

ShadowingOverCosines::ShadowingOverCosines(const SurfaceOptions& options)
    : shadowing_(options.shadowing),
      distribution_(options.shadowing_distribution.value_or(options.distribution)),
      alpha_(options.beckmann_alpha) {
    validate(options);
}

double ShadowingOverCosines::cosine_over_masking(double mu) const {
    return rte::cosine_over_masking(distribution_, alpha_, mu);
}

double ShadowingOverCosines::operator()(const FacetGeometry& geometry) const {
    const bool smith = shadowing_ != Shadowing::v_cavity;
    return (*this)(geometry, smith ? cosine_over_masking(geometry.mu_in) : 0.0);
}

double ShadowingOverCosines::operator()(const FacetGeometry& g, double in_over_masking) const {
    if (shadowing_ == Shadowing::v_cavity) {
        // G = min(1, 2 cos_half mu / cos_facet) with the smaller mu; divided by both cosines.
        const double grooves = 2.0 * g.cos_half / (g.cos_facet * std::max(g.mu_in, g.mu_out));
        return std::min(1.0 / (g.mu_in * g.mu_out), grooves);
    }
    const double out_over_masking = cosine_over_masking(g.mu_out);
    if (shadowing_ == Shadowing::smith_separable) return 1.0 / (in_over_masking * out_over_masking);
    // mu_in mu_out (1 + Lambda_in + Lambda_out) from mu (1 + Lambda) of both.
    return 1.0 / (g.mu_out * in_over_masking + g.mu_in * (out_over_masking - g.mu_out));
}

}  // namespace miebrdf::rte
