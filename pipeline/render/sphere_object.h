// A sphere for rays to meet, in closed form.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "pipeline/render/ray.h"

namespace miebrdf::render {

struct SphereObject {
    Eigen::Vector3d centre;
    double radius;

    /// Distance along a ray to its first point on the sphere, infinite where there is none.
    double distance_along(const Ray& ray) const;
    /// The first point itself; its normal looks outwards.
    std::optional<Hit> intersect(const Ray& ray) const;
};

}  // namespace miebrdf::render
