#include "pipeline/formats/polar_grid.h"

#include <fmt/format.h>

#include <algorithm>

#include <miebrdf/error.h>

namespace miebrdf::exports {

PolarGrid make_polar_grid(const std::string& format, int intervals) {
    if (!(intervals >= 3 && intervals <= 180)) {
        throw UsageError(fmt::format(
            "{}: resolution {} is out of range; allowed: 3 to 180 steps of a quarter turn", format,
            intervals));
    }
    constexpr double kLargestAngle = 89.0;
    PolarGrid grid;
    for (int i = 0; i <= intervals; ++i) {
        const double theta = std::min(90.0 * i / intervals, kLargestAngle);
        if (grid.theta_deg.empty() || theta > grid.theta_deg.back())
            grid.theta_deg.push_back(theta);
        grid.azimuth_deg.push_back(180.0 * i / intervals);
    }
    return grid;
}

}  // namespace miebrdf::exports
