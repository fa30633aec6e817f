// The measured-BSDF files that Mitsuba 3 and pbrt-v4 call `measured`: docs/formats/rgl.md.
#pragma once

#include <iosfwd>

#include "pipeline/solve/rgb_source.h"

namespace miebrdf::exports {

struct RglOptions {
    int resolution = 64;       ///< N of the N x N half vectors for each incidence, 4 to 1024
    int incident_angles = 24;  ///< 2 to 512, from the normal to the horizon
};

/// The spectral file: every wavelength of the source, for pbrt-v4 and Mitsuba's spectral variants.
/// @throws UsageError  options out of range, or a source without wavelengths; Cancelled
void write_rgl_spectral(const BrdfSource& source, const RglOptions& options, std::ostream& out,
                        const RunControl& control = {});

/// The RGB file, for Mitsuba's RGB variants; they refuse the spectral one.
void write_rgl_rgb(const RgbSource& source, const RglOptions& options, std::ostream& out,
                   const RunControl& control = {});

}  // namespace miebrdf::exports
