// A BRDF over all outgoing directions, seen from above.
#pragma once

#include <string>
#include <vector>

#include "pipeline/plot/axis.h"
#include "pipeline/plot/picture.h"

namespace miebrdf::plot {

/// Values at the centres of cells of the hemisphere.
struct HemisphereMap {
    /// Edges of the cells: zenith angles ascending in [0, 90], azimuths ascending, spanning at most
    /// 360. With azimuths from 0 to 180 the other half is mirrored.
    std::vector<double> zenith_edges_deg, azimuth_edges_deg;
    /// value[z * azimuth cells + a]
    std::vector<double> value;
    double incidence_deg = 0.0;
    std::string value_label = "BRDF [1/sr]";
    Scale scale = Scale::linear;
};

/// The radius is the zenith angle; azimuth 0, the mirror side, is on the right, and the source on
/// the left (open circle; the mirror direction is a cross).
/// @throws std::invalid_argument  edges or number of values that do not fit, nothing to show
Picture draw_hemisphere(const HemisphereMap& map, const Caption& caption);

}  // namespace miebrdf::plot
