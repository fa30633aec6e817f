#include <miebrdf/sizes.h>

#include <fmt/format.h>

#include <algorithm>
#include <boost/math/tools/roots.hpp>
#include <cmath>
#include <stdexcept>

#include "mie/sizes/area_laws.h"
#include "mie/sizes/size_table.h"

namespace miebrdf::mie {
namespace {

void validate(const SizeDistribution& d) {
    if (d.kind == SizeDistributionKind::tabulated) return validate_table(d);
    if (!(d.effective_radius_um > 0 && std::isfinite(d.effective_radius_um))) {
        throw std::invalid_argument(fmt::format(
            "effective radius {} um; allowed: positive and finite", d.effective_radius_um));
    }
    if (d.kind == SizeDistributionKind::mono) return;
    if (!(d.effective_variance > 0 && d.effective_variance <= 10)) {
        throw std::invalid_argument(
            fmt::format("effective variance {}; allowed: above 0, up to 10", d.effective_variance));
    }
}

// The two conditions on r1 and r2 = r1 exp(2u) leave u coth u = 1 + v_eff, where u lies in
// (0, 1 + v_eff].
double half_log_ratio(double variance) {
    const auto excess = [variance](double u) { return u / std::tanh(u) - (1 + variance); };
    // u coth u = 1 + u^2/3 - ...: below this the root is sqrt(3 v) to rounding.
    if (variance < 1e-9) return std::sqrt(3 * variance);
    const double lower = std::sqrt(3 * variance) * 0.999;
    const double upper = std::sqrt(3 * variance) + 1 + variance;
    std::uintmax_t steps = 200;
    const auto bracket = boost::math::tools::toms748_solve(
        excess, lower, upper, boost::math::tools::eps_tolerance<double>(52), steps);
    return 0.5 * (bracket.first + bracket.second);
}

RadiusRange power_law_range(const SizeDistribution& d) {
    const double u = half_log_ratio(d.effective_variance);
    const double smallest = d.effective_radius_um * 2 * u / std::expm1(2 * u);
    return {smallest, smallest * std::exp(2 * u)};
}

// The area laws weighted by a further r^4, and the mean of r^4: scattering in Rayleigh's limit.
boost::math::gamma_distribution<> scattering_gamma(const SizeDistribution& d) {
    return {1 / d.effective_variance + 4, d.effective_radius_um * d.effective_variance};
}
double mean_fourth_power(const boost::math::gamma_distribution<>& area) {
    const double s = area.shape();
    return s * (s + 1) * (s + 2) * (s + 3) * std::pow(area.scale(), 4);
}
boost::math::lognormal_distribution<> scattering_log_normal(const SizeDistribution& d) {
    const auto area = area_log_normal(d);
    return {area.location() + 4 * area.scale() * area.scale(), area.scale()};
}
double mean_fourth_power(const boost::math::lognormal_distribution<>& area) {
    return std::exp(4 * area.location() + 8 * area.scale() * area.scale());
}

template <typename Distribution>
RadiusRange between_tails(const Distribution& area, const Distribution& scattering, double tail,
                          double saturation) {
    using boost::math::complement;
    double largest = 0;
    // As if all were small, and what is scattered really: mean of x^4 and of min(1, x^4).
    const double as_small = saturation > 0 ? mean_fourth_power(area) / std::pow(saturation, 4) : 0;
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

}  // namespace

RadiusRange radius_range(const SizeDistribution& distribution, double tail,
                         double saturation_radius_um) {
    validate(distribution);
    if (!(tail >= 1e-18 && tail <= 0.1)) {
        throw std::invalid_argument(fmt::format("tail {}; allowed: 1e-18 to 0.1", tail));
    }
    switch (distribution.kind) {
        case SizeDistributionKind::power_law:
            return power_law_range(distribution);
        case SizeDistributionKind::gamma:
            return between_tails(area_gamma(distribution), scattering_gamma(distribution), tail,
                                 saturation_radius_um);
        case SizeDistributionKind::log_normal:
            return between_tails(area_log_normal(distribution), scattering_log_normal(distribution),
                                 tail, saturation_radius_um);
        case SizeDistributionKind::tabulated:
            return {distribution.radii_um.front(), distribution.radii_um.back()};
        case SizeDistributionKind::mono:
            break;
    }
    return {distribution.effective_radius_um, distribution.effective_radius_um};
}

RadiusRange radius_range(const SizeDistribution& distribution) {
    return radius_range(distribution, 1e-16);
}

double area_share_within(const SizeDistribution& distribution, const RadiusRange& range) {
    const auto outside = [&range](const auto& area) {
        return cdf(area, range.smallest_um) + cdf(complement(area, range.largest_um));
    };
    switch (distribution.kind) {
        case SizeDistributionKind::gamma:
            return 1 - outside(area_gamma(distribution));
        case SizeDistributionKind::log_normal:
            return 1 - outside(area_log_normal(distribution));
        default:
            return 1;
    }
}

double effective_radius_of(const SizeDistribution& distribution) {
    validate(distribution);
    if (distribution.kind != SizeDistributionKind::tabulated)
        return distribution.effective_radius_um;
    return table_integral(distribution, 3) / table_integral(distribution, 2);
}

}  // namespace miebrdf::mie
