// Laws without ends: cut where their tails no longer matter, and sampled by quantiles.
#pragma once

#include <algorithm>
#include <boost/math/policies/policy.hpp>
#include <cmath>
#include <memory>

#include "mie/sizes/size_law.h"

namespace miebrdf::mie {

/// Boost's functions in double. By default they compute in long double, whose powers made quantiles
/// of gamma distributions take longer than Mie theory of small spheres; radii need no such digits.
using InDouble = boost::math::policies::policy<boost::math::policies::promote_double<false>>;

/// The radii between which all but `tail` is scattered on either side.
///
/// @param area  n r^2 as a law of probability with Boost's cdf, pdf and quantile
/// @param scattering  the same weighted by a further r^4: scattering in Rayleigh's limit
/// @param mean_fourth_power  <r^4> of `area`
template <typename Law>
RadiusRange between_tails(const Law& area, const Law& scattering, double mean_fourth_power,
                          double tail, double saturation) {
    double largest = 0;
    // Two means: of x^4, as if all spheres were small, and of min(1, x^4), as they really scatter.
    const double as_small = saturation > 0 ? mean_fourth_power / std::pow(saturation, 4) : 0;
    if (!(saturation > 0)) {
        largest = quantile(complement(area, tail));
    } else {
        const double scattered =
            cdf(complement(area, saturation)) + as_small * cdf(scattering, saturation);
        // Each cut leaves out `tail` of what is scattered at most.
        largest = as_small > 1 ? quantile(complement(area, tail * scattered))
                               : quantile(complement(scattering, tail * scattered / as_small));
    }
    // A long tail of dust has no smallest radius; 1e-6 of the largest scatters nothing.
    return {std::max(quantile(area, tail), 1e-6 * largest), largest};
}

/// Radii whose density is that of a law of probability, within a range.
template <typename Law>
MappedRadius mapped_by_quantile(const Law& density, const RadiusRange& range, double t) {
    const double below = cdf(density, range.smallest_um);
    const double share = cdf(density, range.largest_um) - below;
    const double radius = quantile(density, below + t * share);
    return {radius, share / pdf(density, radius)};
}

/// The entry of a law: `area` gives n r^2 as a law of probability, `weighted` that times a power of
/// r, Density is made of the sizes.
template <auto area, auto weighted, typename Density>
constexpr SizeLaw endless(SizeLaw law) {
    law.has_ends = false;
    law.area_density = [](const SizeDistribution& d) -> std::unique_ptr<const AreaDensity> {
        return std::make_unique<Density>(d);
    };
    law.area_share_within = [](const SizeDistribution& d, const RadiusRange& range) {
        const auto density = area(d);
        return 1 - (cdf(density, range.smallest_um) + cdf(complement(density, range.largest_um)));
    };
    law.forward_radius_um = [](const SizeDistribution& d, double share) {
        return quantile(complement(weighted(area(d), 2), share));
    };
    return law;
}

}  // namespace miebrdf::mie
