#include "pipeline/render/direction_sampling.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "pipeline/render/half_vector.h"

namespace miebrdf::render {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kLobeShare = 0.5;

}  // namespace

DirectionSampler::DirectionSampler(const Eigen::Vector3d& normal,
                                   const Eigen::Vector3d& towards_viewer, double lobe_alpha)
    : normal_(normal),
      viewer_(towards_viewer),
      alpha_(lobe_alpha),
      lobe_share_(lobe_alpha > 0.0 ? kLobeShare : 0.0) {
    // The axis least aligned with the normal gives a well-conditioned tangent.
    Eigen::Index axis = 0;
    normal.cwiseAbs().minCoeff(&axis);
    tangent_ = Eigen::Vector3d::Unit(axis).cross(normal).normalized();
    bitangent_ = normal.cross(tangent_);
}

Eigen::Vector3d DirectionSampler::to_world(double cos_polar, double azimuth) const {
    const double sin_polar = std::sqrt(std::max(0.0, (1 - cos_polar) * (1 + cos_polar)));
    return (sin_polar * std::cos(azimuth) * tangent_ + sin_polar * std::sin(azimuth) * bitangent_ +
            cos_polar * normal_)
        .normalized();
}

Eigen::Vector3d DirectionSampler::sample(std::array<double, 2> u) const {
    const double azimuth = 2 * kPi * u[1];
    // The first number chooses the way; what remains of it is as evenly spread as it was.
    if (u[0] >= lobe_share_) {
        return to_world(std::sqrt((1 - u[0]) / (1 - lobe_share_)), azimuth);
    }
    const double tan2 = -alpha_ * alpha_ * std::log1p(-u[0] / lobe_share_);
    const Eigen::Vector3d half = to_world(1 / std::sqrt(1 + tan2), azimuth);
    return (2 * viewer_.dot(half) * half - viewer_).normalized();
}

double DirectionSampler::density(const Eigen::Vector3d& direction) const {
    const double cosine = std::max(0.0, direction.dot(normal_));
    double density = (1 - lobe_share_) * cosine / kPi;
    if (lobe_share_ > 0.0) {
        const Eigen::Vector3d half = (direction + viewer_).normalized();
        const double cos_normal = half.dot(normal_), cos_light = half.dot(viewer_);
        if (cos_normal > 0.0 && cos_light > 0.0) {
            density +=
                lobe_share_ * beckmann_density(cos_normal, alpha_) * cos_normal / (4 * cos_light);
        }
    }
    return density;
}

}  // namespace miebrdf::render
