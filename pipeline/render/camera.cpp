#include "pipeline/render/camera.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace miebrdf::render {

Camera::Camera(const Bounds& object, const Eigen::Vector3d& towards_camera,
               double field_of_view_deg, double zoom, double aspect)
    : orthographic_(field_of_view_deg == 0.0) {
    if (!(field_of_view_deg >= 0.0 && field_of_view_deg <= 120.0)) {
        throw std::invalid_argument(fmt::format(
            "field of view {} degrees; allowed: 0 (parallel) to 120", field_of_view_deg));
    }
    if (!(zoom > 0.0)) throw std::invalid_argument(fmt::format("zoom {}; allowed: above 0", zoom));
    forward_ = -towards_camera.normalized();
    const Eigen::Vector3d right = forward_.cross(Eigen::Vector3d::UnitY());
    if (!(right.norm() > 1e-6)) throw std::invalid_argument("the camera looks straight up or down");
    right_ = right.normalized();
    up_ = right_.cross(forward_);

    const double radius = object.radius;
    const double half_angle = 0.5 * field_of_view_deg * std::numbers::pi / 180;
    // The tangent cone of the bounding sphere fills the field of view at this distance.
    const double distance = orthographic_ ? 4 * radius : radius / std::sin(half_angle);
    const double half_size = (orthographic_ ? radius : std::tan(half_angle)) / zoom;
    eye_ = object.centre() - distance * forward_;
    right_ *= half_size * std::max(1.0, aspect);
    up_ *= half_size * std::max(1.0, 1.0 / aspect);
}

Ray Camera::ray(double x, double y) const {
    const Eigen::Vector3d offset = (2 * x - 1) * right_ + (1 - 2 * y) * up_;
    if (orthographic_) return {eye_ + offset, forward_};
    return {eye_, (forward_ + offset).normalized()};
}

}  // namespace miebrdf::render
