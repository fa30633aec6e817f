// Surface scattering distribution data (SSDD, libbsdf): docs/formats/ssdd.md.
#pragma once

#include <iosfwd>

#include "pipeline/solve/brdf_source.h"

namespace miebrdf::exports {

/// Every wavelength at polar angles 0, 90/n, ... and azimuths of 180/n degrees; the last polar
/// angle is 89 degrees, since readers interpolate linearly and a BRDF may be steep at the horizon.
/// @param intervals  n, 3 to 180
/// @throws UsageError; Cancelled
void write_ssdd(const BrdfSource& source, int intervals, std::ostream& out,
                const RunControl& control = {});

}  // namespace miebrdf::exports
