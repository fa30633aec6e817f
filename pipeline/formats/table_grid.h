// A BRDF at every combination of three lists of directions, for the formats that are plain tables.
#pragma once

#include <vector>

#include "pipeline/solve/brdf_source.h"

namespace miebrdf::exports {

struct TableGrid {
    std::vector<double> mu_in;        ///< in (0, 1]
    std::vector<double> mu_out;       ///< in (0, 1]
    std::vector<double> azimuth_deg;  ///< 0 = mirror side

    std::size_t size() const { return mu_in.size() * mu_out.size() * azimuth_deg.size(); }
};

/// `intervals` cosines sin^2(pi k / 2 intervals), k >= 1: dense at the horizon and at the normal.
std::vector<double> sine_squared_cosines(int intervals);

/// `count` equally spaced numbers from first to last, both included.
std::vector<double> equally_spaced(double first, double last, int count);

/// @throws UsageError  for an empty list or directions out of range
void validate(const TableGrid& grid);

/// [wavelength][mu_in][mu_out][azimuth], azimuth fastest.
/// @throws UsageError  for an empty list, directions out of range or a source without wavelengths;
///         Cancelled
std::vector<double> tabulate(const BrdfSource& source, const TableGrid& grid,
                             const RunControl& control);

}  // namespace miebrdf::exports
