// Unit vectors and half vectors, for formats that do not use cosines and azimuth.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numbers>

#include <miebrdf/brdf_source.h>

namespace miebrdf {

inline constexpr double kDegree = std::numbers::pi / 180.0;

/// Both vectors point away from the surface, z along the normal.
struct VectorPair {
    Eigen::Vector3d in;
    Eigen::Vector3d out;
};

inline Eigen::Vector3d spherical(double theta, double phi) {
    return {std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
}

/// `direction` mirrored at `half`: the outgoing vector whose half vector with it is `half`.
inline Eigen::Vector3d mirrored(const Eigen::Vector3d& direction, const Eigen::Vector3d& half) {
    return 2.0 * half.dot(direction) * half - direction;
}

/// The incident vector lies in the x-z plane at azimuth 0; azimuth_deg 0 (the mirror side) is then
/// azimuth 180 degrees of the outgoing one.
inline VectorPair vectors_of(const Direction& direction) {
    const double sin_in = std::sqrt((1 - direction.mu_in) * (1 + direction.mu_in));
    const double sin_out = std::sqrt((1 - direction.mu_out) * (1 + direction.mu_out));
    const double azimuth = direction.azimuth_deg * kDegree;
    return {{sin_in, 0.0, direction.mu_in},
            {-sin_out * std::cos(azimuth), sin_out * std::sin(azimuth), direction.mu_out}};
}

/// The inverse of vectors_of, for any two vectors above the horizon.
inline Direction direction_of(const Eigen::Vector3d& in, const Eigen::Vector3d& out) {
    const double dot = in.x() * out.x() + in.y() * out.y();
    const double cross = in.x() * out.y() - in.y() * out.x();
    return {std::min(in.z(), 1.0), std::min(out.z(), 1.0), std::atan2(cross, -dot) / kDegree};
}

}  // namespace miebrdf
