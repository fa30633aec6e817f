// Rusinkiewicz's half and difference angles as pairs of directions.
#pragma once

#include <optional>

#include "pipeline/solve/brdf_source.h"

namespace miebrdf::plot {

/// The half vector between light and view is tilted by theta_h from the normal; the light is tilted
/// by theta_d from the half vector, at azimuth phi_d about it (0: away from the normal, so that the
/// light is the lower of the two). At phi_d = 90 both cosines are cos(theta_h) cos(theta_d).
/// Rusinkiewicz 1998, "A new change of variables for efficient BRDF representation".
/// @return  nothing where light or view is not above the horizon
std::optional<exports::Direction> slice_direction(double theta_h_deg, double theta_d_deg,
                                                  double phi_d_deg);

}  // namespace miebrdf::plot
