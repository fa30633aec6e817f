// The power law of Hansen & Travis (1974), and spheres of one size.
#include <boost/math/tools/roots.hpp>
#include <cmath>

#include "mie/sizes/size_law.h"

namespace miebrdf::mie {
namespace {

// The two conditions on r1 and r2 = r1 exp(2u), r1 + r2 = 2 r_eff (1 + v_eff) and
// (r2 - r1) / ln(r2 / r1) = r_eff, leave u coth u = 1 + v_eff, where u lies in (0, 1 + v_eff].
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

RadiusRange power_law_range(const SizeDistribution& d, double, double) {
    const double u = half_log_ratio(d.effective_variance);
    const double smallest = d.effective_radius_um * 2 * u / std::expm1(2 * u);
    return {smallest, smallest * std::exp(2 * u)};
}

// n r^2 ~ 1/r between the ends.
class PowerLawDensity : public AreaDensity {
  public:
    explicit PowerLawDensity(const RadiusRange& range)
        : log_ratio_(std::log(range.largest_um / range.smallest_um)) {}

    double at(double radius_um) const override { return 1 / (radius_um * log_ratio_); }

  private:
    double log_ratio_;
};

RadiusRange one_size(const SizeDistribution& d, double, double) {
    return {d.effective_radius_um, d.effective_radius_um};
}

}  // namespace

extern const SizeLaw kPowerLaw;
constinit const SizeLaw kPowerLaw{
    .name = "power-law",
    .help = "n(r) ~ r^-3 between two ends",
    .range = power_law_range,
    .area_density = [](const SizeDistribution& d) -> std::unique_ptr<const AreaDensity> {
        return std::make_unique<PowerLawDensity>(power_law_range(d, 0, 0));
    },
};

extern const SizeLaw kMono;
constinit const SizeLaw kMono{
    .name = "mono",
    .help = "every sphere has the effective radius",
    .has_variance = false,
    .single_size = true,
    .range = one_size,
};

}  // namespace miebrdf::mie
