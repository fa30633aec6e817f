// The gamma distribution of Hansen & Travis (1974): n(r) ~ r^((1 - 3b)/b) exp(-r / (a b)), with the
// effective radius a and the effective variance b.
#include <boost/math/distributions/gamma.hpp>
#include <cmath>

#include "mie/sizes/endless_law.h"

namespace miebrdf::mie {
namespace {

using Gamma = boost::math::gamma_distribution<double, InDouble>;

// n r^2 is a gamma density of shape 1/b and scale a b.
Gamma gamma_area(const SizeDistribution& d) {
    return Gamma(1 / d.effective_variance, d.effective_radius_um * d.effective_variance);
}

Gamma weighted_gamma(const Gamma& area, double power) {
    return Gamma(area.shape() + power, area.scale());
}

double mean_fourth_power(const Gamma& area) {
    const double s = area.shape();
    return s * (s + 1) * (s + 2) * (s + 3) * std::pow(area.scale(), 4);
}

RadiusRange gamma_range(const SizeDistribution& d, double tail, double saturation) {
    const Gamma area = gamma_area(d);
    return between_tails(area, weighted_gamma(area, 4), mean_fourth_power(area), tail, saturation);
}

class GammaDensity : public AreaDensity {
  public:
    explicit GammaDensity(const SizeDistribution& d) : law_(gamma_area(d)) {}

    double at(double radius_um) const override { return pdf(law_, radius_um); }

  private:
    Gamma law_;
};

// The cube root of a gamma density (shape s, scale c) is one of shape (s + 2)/3 and scale 3 c.
MappedRadius gamma_radius_at(const SizeDistribution& d, const RadiusRange& range, double t,
                             SizeSpacing) {
    const double shape = 1 / d.effective_variance;
    const Gamma density((shape + 2) / 3, 3 * d.effective_radius_um * d.effective_variance);
    return mapped_by_quantile(density, range, t);
}

}  // namespace

extern const SizeLaw kGamma;
constinit const SizeLaw kGamma = endless<gamma_area, weighted_gamma, GammaDensity>({
    .name = "gamma",
    .help = "n(r) ~ r^(1/b - 3) exp(-r / (a b)), effective radius a and variance b",
    .range = gamma_range,
    .radius_at = gamma_radius_at,
});

}  // namespace miebrdf::mie
