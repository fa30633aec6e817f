// Rusinkiewicz's half and difference angles as pairs of directions.
#pragma once

#include <miebrdf/brdf_source.h>

#include <optional>
#include <string>
#include <vector>

#include "pipeline/plot/axis.h"
#include "pipeline/plot/picture.h"
#include "pipeline/plot/pixel_map.h"

namespace miebrdf::plot {

/// The half vector between light and view is tilted by theta_h from the normal; the light is tilted
/// by theta_d from the half vector, at azimuth phi_d about it (0: away from the normal, so that the
/// light is the lower of the two). At phi_d = 90 both cosines are cos(theta_h) cos(theta_d).
/// Rusinkiewicz 1998, "A new change of variables for efficient BRDF representation".
/// @return  nothing where light or view is not above the horizon
std::optional<Direction> slice_direction(double theta_h_deg, double theta_d_deg, double phi_d_deg);

// A BRDF as an image over half and difference angle (Rusinkiewicz 1998).

/// Values at the centres of equal cells of theta_h (0 to 90, along x) and theta_d (0 to 90, along
/// y) for one phi_d: the left edge is the mirror direction, the bottom edge retro-reflection, the
/// top and the right edge grazing (slice_directions.h).
struct SliceMap {
    int half_cells = 0, difference_cells = 0;
    std::vector<double>
        value;  ///< value[d * half_cells + h]; not finite where there is no direction
    double azimuth_deg = 90.0;  ///< phi_d
    /// Ends of the colours where they should not be those of all values; what lies beyond has the
    /// colour of the end.
    std::optional<double> lowest = {}, highest = {};
    std::string value_label = "BRDF [1/sr]";
    Scale scale = Scale::logarithmic;
};

/// The colours of the cells, theta_h to the right and theta_d upwards.
/// @throws std::invalid_argument  when the number of values does not fit
PixelMap pixels_of(const SliceMap& map, const Axis& axis);

/// @throws std::invalid_argument  when the number of values does not fit, nothing to show
Picture draw_slice(const SliceMap& map, const Caption& caption);

}  // namespace miebrdf::plot
