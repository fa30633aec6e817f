// Radiance's BSDF XML: Klems matrices and tensor trees. docs/formats/radiance.md
#pragma once

#include <iosfwd>

#include "pipeline/exports/rgb_source.h"

namespace miebrdf::exports {

/// A matrix of averages over 145 x 145 patches (LBNL/Klems Full), for Y, X and Z.
/// @throws Cancelled
void write_radiance_klems(const RgbSource& source, std::ostream& out,
                          const RunControl& control = {});

/// An isotropic tensor tree (TensorTree3, LBNL/Shirley-Chiu) as one full grid of 2^levels cells a
/// side: luminance, and the chromaticity u', v'.
/// @param levels  2 to 8
/// @throws UsageError; Cancelled
void write_radiance_tree(const RgbSource& source, int levels, std::ostream& out,
                         const RunControl& control = {});

}  // namespace miebrdf::exports
