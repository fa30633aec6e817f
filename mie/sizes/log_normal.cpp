// The log-normal distribution: n(r) ~ exp(-ln^2(r / r_g) / (2 s)) / r with s = ln(1 + v_eff) and
// r_eff = r_g exp(5/2 s).
#include <boost/math/distributions/lognormal.hpp>
#include <cmath>

#include "mie/sizes/endless_law.h"

namespace miebrdf::mie {
namespace {

using LogNormal = boost::math::lognormal_distribution<double, InDouble>;

// n r^2 is again log-normal, its location moved by 2 s.
LogNormal log_normal_area(const SizeDistribution& d) {
    const double variance = std::log1p(d.effective_variance);
    return {std::log(d.effective_radius_um) - 0.5 * variance, std::sqrt(variance)};
}

LogNormal weighted_log_normal(const LogNormal& area, double power) {
    return {area.location() + power * area.scale() * area.scale(), area.scale()};
}

double mean_fourth_power(const LogNormal& area) {
    return std::exp(4 * area.location() + 8 * area.scale() * area.scale());
}

RadiusRange log_normal_range(const SizeDistribution& d, double tail, double saturation) {
    const LogNormal area = log_normal_area(d);
    return between_tails(area, weighted_log_normal(area, 4), mean_fourth_power(area), tail,
                         saturation);
}

class LogNormalDensity : public AreaDensity {
  public:
    explicit LogNormalDensity(const SizeDistribution& d) : law_(log_normal_area(d)) {}

    double at(double radius_um) const override { return pdf(law_, radius_um); }

  private:
    LogNormal law_;
};

// The cube root of a log-normal density (location u, variance s) is one of location u + 2 s and
// variance 3 s.
MappedRadius log_normal_radius_at(const SizeDistribution& d, const RadiusRange& range, double t,
                                  SizeSpacing) {
    const double variance = std::log1p(d.effective_variance);
    const LogNormal density(std::log(d.effective_radius_um) + 1.5 * variance,
                            std::sqrt(3 * variance));
    return mapped_by_quantile(density, range, t);
}

}  // namespace

extern const SizeLaw kLogNormal;
constinit const SizeLaw kLogNormal =
    endless<log_normal_area, weighted_log_normal, LogNormalDensity>({
        .name = "log-normal",
        .help = "n(r) ~ exp(-ln^2(r / r_g) / (2 s)) / r, s = ln(1 + effective variance)",
        .range = log_normal_range,
        .radius_at = log_normal_radius_at,
    });

}  // namespace miebrdf::mie
