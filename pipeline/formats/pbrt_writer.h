// The Fourier BSDF file of pbrt-v3 and layerlab ("SCATFUN"): docs/formats/pbrt.md.
#pragma once

#include <iosfwd>

#include "pipeline/solve/rgb_source.h"

namespace miebrdf::exports {

struct PbrtOptions {
    /// Intervals h of each half of the cosine axis, 4 to 500; nodes are sin^2(pi k / 2h), which
    /// crowd at the horizon, where the BRDF bends, and at the normal.
    int intervals = 56;
    /// A series is cut where the rest is below this share of its mean.
    double tail_tolerance = 1e-5;
    int most_orders = 512;
};

/// Writes reflection from the lit top side, three channels (Y, R, B of linear sRGB). Rows at the
/// horizon hold the limit of the BRDF, on both sides: a subsurface BRDF does not vanish there, and
/// a reader that interpolates towards empty rows loses several per cent of the albedo.
/// @throws UsageError  intervals out of range; Cancelled
void write_pbrt(const RgbSource& source, const PbrtOptions& options, std::ostream& out,
                const RunControl& control = {});

}  // namespace miebrdf::exports
