// Radiance's BSDF XML as a Klems matrix, for Radiance and WINDOW: docs/formats/radiance.md.
#pragma once

#include <iosfwd>

#include "pipeline/solve/rgb_source.h"

namespace miebrdf::exports {

/// A matrix of averages over 145 x 145 patches (LBNL/Klems Full), for Y, X and Z.
/// @throws Cancelled
void write_radiance_klems(const RgbSource& source, std::ostream& out,
                          const RunControl& control = {});

}  // namespace miebrdf::exports
