#include "mie/size_distribution.h"

#include <fmt/format.h>

#include <algorithm>
#include <boost/math/constants/constants.hpp>
#include <boost/math/distributions/gamma.hpp>
#include <boost/math/distributions/lognormal.hpp>
#include <boost/math/tools/roots.hpp>
#include <cmath>
#include <stdexcept>

#include "rte/math/quadrature.h"

namespace miebrdf::mie {
namespace {

void validate_table(const SizeDistribution& d) {
    if (d.radii_um.size() < 2 || d.radii_um.size() != d.number_density.size()) {
        throw std::invalid_argument(fmt::format(
            "size table with {} radii and {} densities; allowed: as many of both, 2 or more",
            d.radii_um.size(), d.number_density.size()));
    }
    double before = 0, largest = 0;
    for (std::size_t i = 0; i < d.radii_um.size(); ++i) {
        const double radius = d.radii_um[i], density = d.number_density[i];
        if (!(radius > before && std::isfinite(radius) && density >= 0 && std::isfinite(density))) {
            throw std::invalid_argument(fmt::format(
                "size table: density {} at radius {} um; allowed: ascending radii above 0, "
                "densities from 0",
                density, radius));
        }
        before = radius;
        largest = std::max(largest, density);
    }
    if (!(largest > 0))
        throw std::invalid_argument("size table: all densities are 0; allowed: some above");
}

double table_density(const SizeDistribution& d, double radius) {
    const auto above = std::upper_bound(d.radii_um.begin(), d.radii_um.end(), radius);
    if (above == d.radii_um.begin()) return 0;
    if (above == d.radii_um.end()) return radius > d.radii_um.back() ? 0 : d.number_density.back();
    const std::size_t i = static_cast<std::size_t>(above - d.radii_um.begin());
    const double share = (radius - d.radii_um[i - 1]) / (d.radii_um[i] - d.radii_um[i - 1]);
    return (1 - share) * d.number_density[i - 1] + share * d.number_density[i];
}

// Integral of n r^power: three Gauss nodes per interval are exact up to power 4.
double table_integral(const SizeDistribution& d, int power) {
    double sum = 0;
    for (std::size_t i = 1; i < d.radii_um.size(); ++i) {
        const auto rule = math::gauss_legendre(3, d.radii_um[i - 1], d.radii_um[i]);
        for (int node = 0; node < 3; ++node) {
            const double radius = rule.nodes[node];
            sum += rule.weights[node] * table_density(d, radius) * std::pow(radius, power);
        }
    }
    return sum;
}

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

// The two conditions on r1 and r2 = r1 exp(2u) leave u coth u = 1 + v_eff. u lies in (0, 1 +
// v_eff].
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

// n r^2 of the gamma distribution is a gamma density of shape 1/b and scale a b.
boost::math::gamma_distribution<> area_gamma(const SizeDistribution& d) {
    return {1 / d.effective_variance, d.effective_radius_um * d.effective_variance};
}

// n r^2 of the log-normal: again log-normal, its location moved by 2 sigma^2, and
// r_eff = r_g exp(5/2 sigma^2).
boost::math::lognormal_distribution<> area_log_normal(const SizeDistribution& d) {
    const double variance = std::log1p(d.effective_variance);
    return {std::log(d.effective_radius_um) - 0.5 * variance, std::sqrt(variance)};
}

// The same weighted by a further r^4, and the mean of r^4: scattering in Rayleigh's limit.
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

AreaDensity::AreaDensity(const SizeDistribution& distribution)
    : distribution_(distribution),
      range_(radius_range(distribution)),
      log_ratio_(std::log(range_.largest_um / range_.smallest_um)) {
    if (distribution.kind == SizeDistributionKind::mono) {
        throw std::invalid_argument("a single size has no density");
    }
    if (distribution.kind == SizeDistributionKind::tabulated) {
        table_area_ = table_integral(distribution, 2);
        return;
    }
    // The continuation is exp(log n r^2): its real values fix the constant.
    const double r_effective = distribution.effective_radius_um;
    log_norm_ = std::log((*this)(r_effective) / (*this)(std::complex<double>(r_effective)).real());
}

std::complex<double> AreaDensity::operator()(std::complex<double> radius_um) const {
    const double b = distribution_.effective_variance;
    const std::complex<double> relative = radius_um / distribution_.effective_radius_um;
    switch (distribution_.kind) {
        case SizeDistributionKind::gamma:  // r^(1/b - 1) exp(-r / (a b))
            return std::exp((1 / b - 1) * std::log(relative) - (relative - 1.0) / b + log_norm_);
        case SizeDistributionKind::log_normal: {  // exp(-(ln r - ln a + s/2)^2 / (2 s)) / r, s =
                                                  // ln(1+b)
            const double variance = std::log1p(b);
            const std::complex<double> away = std::log(relative) + 0.5 * variance;
            return std::exp(-away * away / (2 * variance) - std::log(relative) + log_norm_);
        }
        default:
            return 1.0 / (radius_um * log_ratio_);
    }
}

double AreaDensity::operator()(double radius_um) const {
    switch (distribution_.kind) {
        case SizeDistributionKind::tabulated:
            return table_density(distribution_, radius_um) * radius_um * radius_um / table_area_;
        case SizeDistributionKind::gamma:
            return pdf(area_gamma(distribution_), radius_um);
        case SizeDistributionKind::log_normal:
            return pdf(area_log_normal(distribution_), radius_um);
        default:
            return 1 / (radius_um * log_ratio_);  // the power law, inside its range
    }
}

}  // namespace miebrdf::mie
