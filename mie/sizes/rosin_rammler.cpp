// The Rosin-Rammler distribution of ground powders and sprays: exp(-(r / r_0)^s) of the volume is
// in particles larger than r (Rosin & Rammler 1933, J. Inst. Fuel 7, 29; Weibull's law). With n r^3
// ~ r^(s-1) exp(-(r / r_0)^s),
//     r_eff = r_0 / Gamma(1 - 1/s),  1 + v_eff = Gamma(1 + 1/s) Gamma(1 - 1/s) = (pi/s) /
//     sin(pi/s).
#include <boost/math/special_functions/gamma.hpp>
#include <boost/math/tools/roots.hpp>
#include <cmath>
#include <numbers>

#include "mie/sizes/endless_law.h"

namespace miebrdf::mie {
namespace {

using std::numbers::pi;

// Radii whose powers (r / scale)^power have a gamma density of this shape, with the functions that
// the laws of Boost.Math have.
struct PowerOfGamma {
    double shape, power, scale;
    double to_gamma(double radius) const { return std::pow(radius / scale, power); }
    double from_gamma(double t) const { return scale * std::pow(t, 1 / power); }
};
struct Complement {
    const PowerOfGamma& law;
    double value;
};
Complement complement(const PowerOfGamma& law, double value) { return {law, value}; }
double cdf(const PowerOfGamma& law, double radius) {
    return boost::math::gamma_p(law.shape, law.to_gamma(radius), InDouble());
}
double cdf(const Complement& c) {
    return boost::math::gamma_q(c.law.shape, c.law.to_gamma(c.value), InDouble());
}
double quantile(const PowerOfGamma& law, double share) {
    return law.from_gamma(boost::math::gamma_p_inv(law.shape, share, InDouble()));
}
double quantile(const Complement& c) {
    return c.law.from_gamma(boost::math::gamma_q_inv(c.law.shape, c.value, InDouble()));
}
double pdf(const PowerOfGamma& law, double radius) {
    const double t = law.to_gamma(radius);
    return law.power / radius * t * boost::math::gamma_p_derivative(law.shape, t, InDouble());
}

// s from x / sin x = 1 + v_eff, x = pi/s in (0, pi).
double exponent_of(const SizeDistribution& d) {
    const double variance = d.effective_variance;
    // x / sin x = 1 + x^2/6 + ...: below this the root is sqrt(6 v) to rounding.
    if (variance < 1e-9) return pi / std::sqrt(6 * variance);
    const auto excess = [variance](double x) { return x - (1 + variance) * std::sin(x); };
    std::uintmax_t steps = 200;
    const auto [lower, upper] =
        boost::math::tools::toms748_solve(excess, std::min(0.5 * std::sqrt(6 * variance), 0.5), pi,
                                          boost::math::tools::eps_tolerance<double>(52), steps);
    return pi / (0.5 * (lower + upper));
}

// n r^2 ~ r^(s-2) exp(-(r / r_0)^s).
PowerOfGamma rosin_rammler_area(const SizeDistribution& d) {
    const double s = exponent_of(d);
    return {1 - 1 / s, s, d.effective_radius_um * std::tgamma(1 - 1 / s)};
}

PowerOfGamma weighted_rosin_rammler(const PowerOfGamma& area, double power) {
    return {area.shape + power / area.power, area.power, area.scale};
}

RadiusRange rosin_rammler_range(const SizeDistribution& d, double tail, double saturation) {
    const PowerOfGamma area = rosin_rammler_area(d);
    const PowerOfGamma scattering = weighted_rosin_rammler(area, 4);
    const double mean_fourth_power =
        std::pow(area.scale, 4) * boost::math::tgamma_ratio(scattering.shape, area.shape);
    return between_tails(area, scattering, mean_fourth_power, tail, saturation);
}

class RosinRammlerDensity : public AreaDensity {
  public:
    explicit RosinRammlerDensity(const SizeDistribution& d) : law_(rosin_rammler_area(d)) {}

    double at(double radius_um) const override { return pdf(law_, radius_um); }

  private:
    PowerOfGamma law_;
};

// The cube root of the area density has the same power, the scale r_0 3^(1/s) and
// r^((s-2)/3) = r^(s shape - 1).
MappedRadius rosin_rammler_radius_at(const SizeDistribution& d, const RadiusRange& range, double t,
                                     SizeSpacing) {
    const auto [shape, s, scale] = rosin_rammler_area(d);
    return mapped_by_quantile(PowerOfGamma{(s + 1) / (3 * s), s, scale * std::pow(3, 1 / s)}, range,
                              t);
}

}  // namespace

extern const SizeLaw kRosinRammler;
constinit const SizeLaw kRosinRammler =
    endless<rosin_rammler_area, weighted_rosin_rammler, RosinRammlerDensity>({
        .name = "rosin-rammler",
        .help = "exp(-(r / r_0)^s) of the volume in particles larger than r",
        .range = rosin_rammler_range,
        .radius_at = rosin_rammler_radius_at,
    });

}  // namespace miebrdf::mie
