#include <cmath>
#include <numbers>

#include <miebrdf/error.h>
#include <miebrdf/sizes.h>
#include "mie/sizes/size_nodes.h"

namespace miebrdf::mie {
namespace {

double mean_within(const SizeDistribution& distribution, const RadiusRange& range, int power) {
    constexpr int kNodes = 2000;
    const SizeNodes nodes = smooth_size_nodes(distribution, range, kNodes);
    double sum = 0.0, number = 0.0;
    for (std::size_t i = 0; i < nodes.radius_um.size(); ++i) {
        const double of_number = nodes.area_share[i] * std::pow(nodes.radius_um[i], -2);
        sum += of_number * std::pow(nodes.radius_um[i], power);
        number += of_number;
    }
    return sum / number;
}

}  // namespace

double mean_radius_power(const SizeDistribution& distribution, int power) {
    const RadiusRange range = radius_range(distribution);
    if (range.smallest_um == range.largest_um) return std::pow(range.largest_um, power);
    // Small particles have no area and all the number: where their count has no end, it grows with
    // every smaller radius that is let in.
    const double mean = mean_within(distribution, range, power);
    const double without_dust = mean_within(distribution, radius_range(distribution, 1e-12), power);
    constexpr double kSettled = 1e-4;
    if (std::abs(mean / without_dust - 1.0) <= kSettled) return mean;
    throw UsageError(
        "this size distribution has so many small particles that their number has no limit; give "
        "a volume or mass fraction in place of a number, and coatings as shares of the radius");
}

double mean_cross_section_um2(const SizeDistribution& distribution) {
    return std::numbers::pi * mean_radius_power(distribution, 2);
}

}  // namespace miebrdf::mie
