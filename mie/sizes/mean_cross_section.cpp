#include <cmath>
#include <numbers>

#include <miebrdf/error.h>
#include <miebrdf/sizes.h>
#include "mie/sizes/size_nodes.h"

namespace miebrdf::mie {
namespace {

double mean_within(const SizeDistribution& distribution, const RadiusRange& range) {
    constexpr int kNodes = 2000;
    const SizeNodes nodes = smooth_size_nodes(distribution, range, kNodes);
    double area = 0.0, number = 0.0;
    for (std::size_t i = 0; i < nodes.radius_um.size(); ++i) {
        const double radius_um = nodes.radius_um[i];
        area += nodes.area_share[i];
        number += nodes.area_share[i] / (std::numbers::pi * radius_um * radius_um);
    }
    return area / number;
}

}  // namespace

double mean_cross_section_um2(const SizeDistribution& distribution) {
    const RadiusRange range = radius_range(distribution);
    if (range.smallest_um == range.largest_um)
        return std::numbers::pi * range.largest_um * range.largest_um;
    // Small particles have no area and all the number: where their count has no end, it grows with
    // every smaller radius that is let in.
    const double mean = mean_within(distribution, range);
    const double without_dust = mean_within(distribution, radius_range(distribution, 1e-12));
    constexpr double kSettled = 1e-4;
    if (std::abs(mean / without_dust - 1.0) <= kSettled) return mean;
    throw UsageError(
        "this size distribution has so many small particles that their number has no limit; give "
        "a volume or mass fraction in place of a number");
}

}  // namespace miebrdf::mie
