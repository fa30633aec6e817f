// BRDF lobes in the plane of incidence.
#pragma once

#include <string>
#include <vector>

#include "pipeline/plot/picture.h"

namespace miebrdf::plot {

/// One curve over the plane of incidence.
struct LobeCurve {
    std::string label;
    /// From the normal: positive on the mirror side (azimuth 0), negative on the source's side
    /// (azimuth 180); ascending, in [-90, 90].
    std::vector<double> angle_deg;
    std::vector<double> value;   ///< one for each angle, >= 0
    double incidence_deg = 0.0;  ///< of the light, in [0, 90); drawn as a ray from the left
};

struct LobeOptions {
    std::string value_label = "BRDF [1/sr]";  ///< or e.g. "BRDF cos \u03b8 [1/sr]"
    bool logarithmic = false;
    int decades = 3;  ///< of a logarithmic radius, 1 to 12
};

/// A half disk: the radius is the value, from 0 or logarithmic over some decades. The source is on
/// the left, the mirror direction on the right.
/// @throws std::invalid_argument  no curve, lengths that differ, angles out of range, nothing
/// positive
Picture draw_lobe(const std::vector<LobeCurve>& curves, const LobeOptions& options,
                  const Caption& caption);

}  // namespace miebrdf::plot
