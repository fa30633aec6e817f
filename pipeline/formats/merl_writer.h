// The MERL `.binary` table: docs/formats/merl.md.
#pragma once

#include <iosfwd>

#include "pipeline/solve/rgb_source.h"

namespace miebrdf::exports {

/// Where in a bin its value is computed. Programs that interpolate (libbsdf) want the lower edge;
/// programs that take the bin as it is (BRDF Explorer) are served better by its centre.
enum class MerlSample { lower_edge, centre };

struct MerlOptions {
    MerlSample sample = MerlSample::lower_edge;
};

/// 90 x 90 x 180 bins of (half angle, difference angle, azimuth of the difference), three channels
/// of doubles, 34,992,012 bytes always. Bins that no pair of directions reaches hold -1.
/// @throws Cancelled
void write_merl(const RgbSource& source, const MerlOptions& options, std::ostream& out,
                const RunControl& control = {});

}  // namespace miebrdf::exports
