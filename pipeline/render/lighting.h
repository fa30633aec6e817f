// Everything that shines on an object.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "pipeline/render/environment.h"

namespace miebrdf::render {

/// Parallel light, as from the sun.
struct DirectionalLight {
    Eigen::Vector3d towards;  ///< unit vector from the object to the light
    Spectrum irradiance;      ///< on a surface that faces the light
};

/// A rectangle that shines evenly from its front; it is not seen by the camera, nor in mirror-like
/// reflections other than through its light.
struct AreaLight {
    Eigen::Vector3d centre;
    Eigen::Vector3d half_width;   ///< from the centre to the middle of an edge
    Eigen::Vector3d half_height;  ///< likewise, perpendicular to half_width
    Spectrum radiance;            ///< on the side of half_width x half_height
};

struct Lighting {
    std::vector<DirectionalLight> directional;
    std::vector<AreaLight> area;
    std::optional<Environment> environment;
};

/// A square that faces `target`.
/// @param towards   unit vector from the target to the light
/// @param distance  of its centre from the target
/// @param size_deg  angle under which its sides appear from the target, in (0, 150]
/// @param irradiance  at the target, on a surface that faces the light
AreaLight square_light(const Eigen::Vector3d& target, const Eigen::Vector3d& towards,
                       double distance, double size_deg, const Spectrum& irradiance);

}  // namespace miebrdf::render
