// Spectral OpenEXR (Fichet, Pacanowski & Wilkie 2021, JCGT 10(3)): docs/formats/exr.md.
#pragma once

#include <iosfwd>

#include "pipeline/formats/table_grid.h"
#include "pipeline/solve/rgb_source.h"

namespace miebrdf::exports {

/// One 32-bit float channel T.<wavelength>nm for each wavelength, and R, G, B of the reflection
/// function (pi times the BRDF) to look at. Column = azimuth, row = mu_in * number of mu_out +
/// mu_out; the three lists are in float-vector attributes of their names.
/// @throws UsageError  as tabulate; InputError when the stream fails; Cancelled
void write_exr(const BrdfSource& source, const RgbWeights& preview, const TableGrid& grid,
               std::ostream& out, const RunControl& control = {});

}  // namespace miebrdf::exports
