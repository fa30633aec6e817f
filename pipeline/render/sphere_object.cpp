#include "pipeline/render/sphere_object.h"

#include <cmath>
#include <limits>

namespace miebrdf::render {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

}  // namespace

double SphereObject::distance_along(const Ray& ray) const {
    const Eigen::Vector3d to_centre = centre - ray.origin;
    const double middle = to_centre.dot(ray.direction);
    const bool is_outside = to_centre.squaredNorm() > radius * radius;
    if (is_outside && middle <= 0.0) return kInfinity;  // what a convex body sends away is gone
    // From the ray's nearest point to the centre, which loses fewer digits at a distance than the
    // textbook's discriminant (Haines et al. 2019, Ray Tracing Gems, ch. 7).
    const double nearest2 = (to_centre - middle * ray.direction).squaredNorm();
    if (!(nearest2 < radius * radius)) return kInfinity;
    const double half_chord = std::sqrt(radius * radius - nearest2);
    return is_outside ? middle - half_chord : middle + half_chord;
}

std::optional<Hit> SphereObject::intersect(const Ray& ray) const {
    const double distance = distance_along(ray);
    if (!(distance < kInfinity)) return std::nullopt;
    Hit hit;
    hit.normal = (ray.origin + distance * ray.direction - centre) / radius;
    hit.normal.normalize();
    hit.facet_normal = hit.normal;
    hit.position = centre + radius * hit.normal;
    hit.uv.setZero();
    return hit;
}

}  // namespace miebrdf::render
