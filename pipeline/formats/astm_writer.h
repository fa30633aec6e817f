// ASTM E1392 text tables: docs/formats/astm.md.
#pragma once

#include <iosfwd>

#include "pipeline/solve/brdf_source.h"

namespace miebrdf::exports {

/// One row for each direction: angles in radians, BRDF at each wavelength. Steps of 90 / n degrees
/// of polar angle (the last at 89) and 180 / n of azimuth over half a turn.
/// @param intervals  n, 3 to 180
/// @throws UsageError; Cancelled
void write_astm(const BrdfSource& source, int intervals, std::ostream& out,
                const RunControl& control = {});

}  // namespace miebrdf::exports
