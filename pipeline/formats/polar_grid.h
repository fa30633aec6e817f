// Equal steps of polar angle and azimuth, for formats that list angles.
#pragma once

#include <string>
#include <vector>

namespace miebrdf::exports {

struct PolarGrid {
    std::vector<double> theta_deg;    ///< 0 ... 89
    std::vector<double> azimuth_deg;  ///< 0 ... 180
};

/// Steps of 90 / n and 180 / n degrees. @param intervals  n, 3 to 180
/// @throws UsageError  naming the format
PolarGrid make_polar_grid(const std::string& format, int intervals);

}  // namespace miebrdf::exports
