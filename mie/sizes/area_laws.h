// Size distributions weighted by the spheres' area, n(r) r^2, as laws of probability.
#pragma once

#include <boost/math/distributions/gamma.hpp>
#include <boost/math/distributions/lognormal.hpp>
#include <cmath>

#include <miebrdf/sizes.h>

namespace miebrdf::mie {

// n r^2 of the gamma distribution is a gamma density of shape 1/b and scale a b.
inline boost::math::gamma_distribution<> area_gamma(const SizeDistribution& d) {
    return {1 / d.effective_variance, d.effective_radius_um * d.effective_variance};
}

// n r^2 of the log-normal: again log-normal, its location moved by 2 sigma^2, and
// r_eff = r_g exp(5/2 sigma^2).
inline boost::math::lognormal_distribution<> area_log_normal(const SizeDistribution& d) {
    const double variance = std::log1p(d.effective_variance);
    return {std::log(d.effective_radius_um) - 0.5 * variance, std::sqrt(variance)};
}

}  // namespace miebrdf::mie
