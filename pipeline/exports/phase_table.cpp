#include "pipeline/exports/phase_table.h"

#include <math.h>  // Boost 1.74 calls ::isnan in pchip.hpp

#include <algorithm>
#include <boost/math/interpolators/pchip.hpp>
#include <cmath>
#include <memory>
#include <numbers>

namespace miebrdf::exports {
namespace {

using Pchip = boost::math::interpolators::pchip<std::vector<double>>;

double rms_of_left_out(const std::vector<double>& angles, const std::vector<double>& values) {
    std::vector<double> kept_angles, kept_values;
    for (std::size_t i = 0; i < angles.size(); ++i) {
        if (i % 2 == 0 || i + 1 == angles.size()) {
            kept_angles.push_back(angles[i]);
            kept_values.push_back(values[i]);
        }
    }
    const Pchip coarse(std::move(kept_angles), std::move(kept_values));
    double sum = 0.0;
    std::size_t count = 0;
    for (std::size_t i = 1; i + 1 < angles.size(); i += 2) {
        if (!(values[i] > 0.0)) continue;
        sum += std::pow(coarse(angles[i]) / values[i] - 1.0, 2);
        ++count;
    }
    return count > 0 ? std::sqrt(sum / static_cast<double>(count)) : 0.0;
}

}  // namespace

std::vector<double> phase_table_angles_deg() {
    // Counted in twentieths of a degree, so that all sums are exact.
    constexpr int kEnd = 3600, kDiffraction = 100, kGlory = 3400, kCoarse = 10;
    std::vector<double> angles;
    for (int i = 0; i <= kEnd; i += i < kDiffraction || i >= kGlory ? 1 : kCoarse) {
        angles.push_back(i / 20.0);
    }
    return angles;
}

PhaseTable::PhaseTable(std::vector<double> angles_deg,
                       const std::function<double(double cos_theta)>& phase) {
    constexpr double kDegree = std::numbers::pi / 180;
    std::vector<double> values;
    for (const double angle : angles_deg) values.push_back(phase(std::cos(angle * kDegree)));
    error_estimate_ = rms_of_left_out(angles_deg, values);
    const auto spline = std::make_shared<const Pchip>(std::move(angles_deg), std::move(values));
    interpolate_ = [spline](double cos_theta) {
        return (*spline)(
            std::clamp(std::acos(std::clamp(cos_theta, -1.0, 1.0)) / kDegree, 0.0, 180.0));
    };
}

}  // namespace miebrdf::exports
