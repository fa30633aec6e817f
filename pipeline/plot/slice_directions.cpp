#include "pipeline/plot/slice_directions.h"

#include "pipeline/solve/vector_pairs.h"

namespace miebrdf::plot {

std::optional<exports::Direction> slice_direction(double theta_h_deg, double theta_d_deg,
                                                  double phi_d_deg) {
    using exports::kDegree;
    const double cos_h = std::cos(theta_h_deg * kDegree), sin_h = std::sin(theta_h_deg * kDegree);
    const Eigen::Vector3d d = exports::spherical(theta_d_deg * kDegree, phi_d_deg * kDegree);
    const Eigen::Vector3d in(cos_h * d.x() + sin_h * d.z(), d.y(), cos_h * d.z() - sin_h * d.x());
    const Eigen::Vector3d out = exports::mirrored(in, {sin_h, 0.0, cos_h});
    // Less than rounding above the horizon is on it.
    if (!(in.z() > 1e-14 && out.z() > 1e-14)) return std::nullopt;
    return exports::direction_of(in, out);
}

}  // namespace miebrdf::plot
