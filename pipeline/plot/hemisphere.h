// A BRDF over all outgoing directions, seen from above.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pipeline/plot/axis.h"
#include "pipeline/plot/picture.h"
#include "pipeline/plot/pixel_map.h"

namespace miebrdf::plot {

/// An outgoing direction: the azimuth is 0 on the mirror side.
struct ViewAngles {
    double zenith_deg = 0.0, azimuth_deg = 0.0;
};

/// A value for each pixel of the upper half of the disk; the lower half is its image.
struct HemisphereMap {
    int size = 0;  ///< pixels across the whole disk: even, 2 to 4096
    /// value[y * size + x], y < size / 2 downwards from the top; what lies outside the disk is not
    /// looked at.
    std::vector<double> value;
    double incidence_deg = 0.0;
    std::string value_label = "BRDF [1/sr]";
    Scale scale = Scale::linear;
};

/// The direction at the centre of a pixel: the distance from the centre is the zenith angle, up to
/// 90 degrees at the rim. Nothing outside the disk.
std::optional<ViewAngles> pixel_angles(int size, int x, int y);

/// The colours of the whole disk.
/// @throws std::invalid_argument  for a size or a number of values that does not fit
PixelMap pixels_of(const HemisphereMap& map, const Axis& axis);

/// The radius is the zenith angle; azimuth 0, the mirror side, is on the right, and the source on
/// the left (open circle; the mirror direction is a cross). The colours span the values up to 85
/// degrees; beyond, they are those of the ends.
/// @throws std::invalid_argument  as pixels_of(), and when there is nothing to show
Picture draw_hemisphere(const HemisphereMap& map, const Caption& caption);

}  // namespace miebrdf::plot
