// Choosing directions of light in proportion to what a surface does with them.
#pragma once

#include <Eigen/Core>
#include <array>

namespace miebrdf::render {

/// Directions around a normal: half of them (all, without a lobe) cosine-distributed, the others
/// mirrored at half vectors from Beckmann's distribution.
class DirectionSampler {
  public:
    /// @param lobe_alpha  Beckmann slope parameter; 0: no lobe
    DirectionSampler(const Eigen::Vector3d& normal, const Eigen::Vector3d& towards_viewer,
                     double lobe_alpha);

    /// A unit direction; it may lie below the surface (a mirrored one), where nothing is reflected.
    Eigen::Vector3d sample(std::array<double, 2> u) const;

    /// Density of sample() per solid angle at a direction above the surface.
    double density(const Eigen::Vector3d& direction) const;

  private:
    Eigen::Vector3d to_world(double cos_polar, double azimuth) const;

    Eigen::Vector3d normal_;
    Eigen::Vector3d tangent_;
    Eigen::Vector3d bitangent_;
    Eigen::Vector3d viewer_;
    double alpha_;
    double lobe_share_;
};

}  // namespace miebrdf::render
