// Junge's law: n(r) ~ r^-exponent between two radii, of any exponent and limits.
#include <fmt/format.h>

#include <cmath>

#include <miebrdf/error.h>
#include "mie/sizes/size_law.h"

namespace miebrdf::mie {
namespace {

void validate_junge(const SizeDistribution& d) {
    if (d.radii_um.size() != 2 ||
        !(d.radii_um[0] > 0 && d.radii_um[1] > d.radii_um[0] && std::isfinite(d.radii_um[1]))) {
        throw UsageError("Junge's law needs two radii above 0, the larger one last");
    }
    if (!(d.exponent >= 0 && d.exponent <= 10)) {
        throw UsageError("exponent of Junge's law", d.exponent, "0 to 10");
    }
}

// Integral of r^power between the limits, over the upper one to power + 1: neither overflows.
double integral(const SizeDistribution& d, double power) {
    const double log_ratio = std::log(d.radii_um[1] / d.radii_um[0]), n = power + 1;
    return std::abs(n) * log_ratio < 1e-8 ? log_ratio : -std::expm1(-n * log_ratio) / n;
}

class JungeDensity : public AreaDensity {
  public:
    explicit JungeDensity(const SizeDistribution& d)
        : power_(2 - d.exponent),
          largest_(d.radii_um[1]),
          scale_(1 / (largest_ * integral(d, power_))) {}

    double at(double radius_um) const override {
        return scale_ * std::pow(radius_um / largest_, power_);
    }

  private:
    double power_, largest_, scale_;
};

// As laws without ends do: the density of sizes follows the cube root of the area density.
MappedRadius junge_radius_at(const SizeDistribution& d, const RadiusRange& range, double t,
                             SizeSpacing spacing) {
    const double n = (2 - d.exponent) / 3 + 1;
    const double log_ratio = std::log(range.largest_um / range.smallest_um);
    if (spacing == SizeSpacing::geometric || std::abs(n) * log_ratio < 1e-8)
        return evenly_spread(d, range, t, SizeSpacing::geometric);
    const double step = std::expm1(n * log_ratio), here = 1 + t * step;
    const double radius = range.smallest_um * std::pow(here, 1 / n);
    return {radius, radius * step / (n * here)};
}

}  // namespace

extern const SizeLaw kJunge;
constinit const SizeLaw kJunge{
    .name = "junge",
    .help = "n(r) ~ r^-exponent between two radii",
    .has_variance = false,
    .validate = validate_junge,
    .range = [](const SizeDistribution& d, double, double) -> RadiusRange {
        return {d.radii_um[0], d.radii_um[1]};
    },
    .area_density = [](const SizeDistribution& d) -> std::unique_ptr<const AreaDensity> {
        return std::make_unique<JungeDensity>(d);
    },
    .effective_radius_um =
        [](const SizeDistribution& d) {
            return d.radii_um[1] * integral(d, 3 - d.exponent) / integral(d, 2 - d.exponent);
        },
    .radius_at = junge_radius_at,
};

}  // namespace miebrdf::mie
