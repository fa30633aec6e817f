// Rays, and where they meet an object.
#pragma once

#include <Eigen/Core>

namespace miebrdf::render {

struct Ray {
    Eigen::Vector3d origin;
    Eigen::Vector3d direction;  ///< unit
};

struct Hit {
    Eigen::Vector3d position;      ///< on the surface
    Eigen::Vector3d normal;        ///< of the surface as it is shaded, unit, on the side of the ray
    Eigen::Vector3d facet_normal;  ///< of the triangle (or sphere), unit, on the side of the ray
    Eigen::Vector2d uv;            ///< texture coordinates; 0 for objects without
};

}  // namespace miebrdf::render
