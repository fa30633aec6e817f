// A size distribution given as a table: radii and number densities, linear in between.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include <miebrdf/error.h>
#include "mie/sizes/size_law.h"
#include "rte/math/quadrature.h"

namespace miebrdf::mie {
namespace {

void validate_table(const SizeDistribution& d) {
    if (d.radii_um.size() < 2 || d.radii_um.size() != d.number_density.size()) {
        throw UsageError(fmt::format(
            "size table with {} radii and {} densities; allowed: as many of both, 2 or more",
            d.radii_um.size(), d.number_density.size()));
    }
    double before = 0, largest = 0;
    for (std::size_t i = 0; i < d.radii_um.size(); ++i) {
        const double radius = d.radii_um[i], density = d.number_density[i];
        if (!(radius > before && std::isfinite(radius) && density >= 0 && std::isfinite(density))) {
            throw UsageError(fmt::format(
                "size table: density {} at radius {} um; allowed: ascending radii above 0, "
                "densities from 0",
                density, radius));
        }
        before = radius;
        largest = std::max(largest, density);
    }
    if (!(largest > 0)) {
        throw UsageError("size table: all densities are 0; allowed: some above");
    }
}

// n at a radius; 0 outside the table.
double table_density(const SizeDistribution& d, double radius) {
    const auto above = std::upper_bound(d.radii_um.begin(), d.radii_um.end(), radius);
    if (above == d.radii_um.begin()) return 0;
    if (above == d.radii_um.end()) return radius > d.radii_um.back() ? 0 : d.number_density.back();
    const std::size_t i = static_cast<std::size_t>(above - d.radii_um.begin());
    const double share = (radius - d.radii_um[i - 1]) / (d.radii_um[i] - d.radii_um[i - 1]);
    return (1 - share) * d.number_density[i - 1] + share * d.number_density[i];
}

// Integral of n(r) r^power dr over the table. Three Gauss nodes per interval are exact up to power
// 4.
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

class TableDensity : public AreaDensity {
  public:
    explicit TableDensity(const SizeDistribution& d)
        : distribution_(d), area_(table_integral(d, 2)) {}

    double at(double radius_um) const override {
        return table_density(distribution_, radius_um) * radius_um * radius_um / area_;
    }

  private:
    SizeDistribution distribution_;
    double area_;
};

}  // namespace

extern const SizeLaw kTabulated;
constinit const SizeLaw kTabulated{
    .name = "tabulated",
    .help = "n(r) as listed, linear in between",
    .has_variance = false,
    .is_without_bends = false,
    .validate = validate_table,
    .range = [](const SizeDistribution& d, double, double) -> RadiusRange {
        return {d.radii_um.front(), d.radii_um.back()};
    },
    .area_density = [](const SizeDistribution& d) -> std::unique_ptr<const AreaDensity> {
        return std::make_unique<TableDensity>(d);
    },
    .effective_radius_um =
        [](const SizeDistribution& d) { return table_integral(d, 3) / table_integral(d, 2); },
};

}  // namespace miebrdf::mie
