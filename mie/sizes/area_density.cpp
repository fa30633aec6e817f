#include "mie/sizes/area_density.h"

#include <cmath>
#include <stdexcept>

#include "mie/sizes/area_laws.h"
#include "mie/sizes/size_table.h"

namespace miebrdf::mie {

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
        case SizeDistributionKind::log_normal: {
            // exp(-(ln r - ln a + s/2)^2 / (2 s)) / r with s = ln(1 + b)
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
