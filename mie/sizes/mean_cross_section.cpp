#include <cmath>
#include <numbers>

#include <miebrdf/error.h>
#include <miebrdf/sizes.h>
#include "mie/sizes/size_law.h"

namespace miebrdf::mie {
namespace {

// Midpoints evenly spread in ln r: h^2 / 24 times the slopes at the ends is 1e-8 for a decade.
double mean_within(const SizeDistribution& distribution, const RadiusRange& range, int power) {
    constexpr int kNodes = 4000;
    const auto density = area_density(distribution);
    const double step = std::log(range.largest_um / range.smallest_um) / kNodes;
    double sum = 0.0, number = 0.0;
    for (int i = 0; i < kNodes; ++i) {
        const double radius = range.smallest_um * std::exp(step * (i + 0.5));
        const double of_number = density->at(radius) / radius;  // n(r) r
        sum += of_number * std::pow(radius, power);
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
