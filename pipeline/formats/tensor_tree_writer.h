// Radiance's BSDF XML as a tensor tree: docs/formats/radiance.md.
#pragma once

#include <iosfwd>

#include "pipeline/solve/rgb_source.h"

namespace miebrdf::exports {

/// An isotropic tensor tree (TensorTree3, LBNL/Shirley-Chiu) as one full grid of 2^levels cells a
/// side: luminance, and the chromaticity u', v'.
/// @param levels  2 to 8
/// @throws UsageError; Cancelled
void write_radiance_tree(const RgbSource& source, int levels, std::ostream& out,
                         const RunControl& control = {});

}  // namespace miebrdf::exports
