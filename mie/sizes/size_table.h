// A size distribution given as a table: radii and number densities, linear in between.
#pragma once

#include <miebrdf/sizes.h>

namespace miebrdf::mie {

/// @throws std::invalid_argument  for lists of unlike length, fewer than 2 rows, radii that do not
/// ascend from above 0, densities that are negative or all 0
void validate_table(const SizeDistribution& distribution);

/// n at a radius; 0 outside the table.
double table_density(const SizeDistribution& distribution, double radius_um);

/// Integral of n(r) r^power dr over the table, exact up to power 4.
double table_integral(const SizeDistribution& distribution, int power);

}  // namespace miebrdf::mie
