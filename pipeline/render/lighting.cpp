#include "pipeline/render/lighting.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace miebrdf::render {

AreaLight square_light(const Eigen::Vector3d& target, const Eigen::Vector3d& towards,
                       double distance, double size_deg, const Spectrum& irradiance) {
    if (!(size_deg > 0.0 && size_deg <= 150.0)) {
        throw std::invalid_argument(
            fmt::format("area light of {} degrees; allowed: (0, 150]", size_deg));
    }
    const double half = std::tan(0.5 * size_deg * std::numbers::pi / 180);
    const bool is_vertical = std::abs(towards.y()) > 0.999;
    const Eigen::Vector3d up = is_vertical ? Eigen::Vector3d::UnitX() : Eigen::Vector3d::UnitY();
    AreaLight light;
    light.centre = target + distance * towards;
    const Eigen::Vector3d right = up.cross(-towards).normalized();
    light.half_width = half * distance * right;
    light.half_height = half * distance * (-towards).cross(right);
    // A square of half-side t at distance 1, parallel to the receiver, has the form factor
    // (4/pi) t/sqrt(1+t^2) atan(t/sqrt(1+t^2)): irradiance = pi * form factor * radiance.
    const double s = half / std::sqrt(1 + half * half);
    for (const double e : irradiance) light.radiance.push_back(e / (4 * s * std::atan(s)));
    return light;
}

}  // namespace miebrdf::render
