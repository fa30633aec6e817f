// Well-spread random numbers that depend on pixel and sample alone, not on threads or their order.
#pragma once

#include <Eigen/Core>

#include <array>
#include <cstdint>

namespace miebrdf::render {

/// A sequence of points in the unit square for one sample of one pixel: the first four Sobol
/// dimensions, Owen-scrambled and shuffled by hashing, anew for every two pairs ("padding"; Burley
/// 2020, Practical hash-based Owen scrambling, J. Computer Graphics Techniques 9(4)). Samples
/// 0 ... 2^k - 1 of a pixel are well spread in every pair for every k, and the first pair (place in
/// the pixel) together with the second (first direction or place on a light) too.
class Sampler {
  public:
    Sampler(std::uint32_t x, std::uint32_t y, std::uint32_t seed, std::uint32_t sample);

    /// The next pair of numbers, each in [0, 1).
    std::array<double, 2> next();

  private:
    std::uint32_t pixel_;
    std::uint32_t sample_;
    std::uint32_t pair_ = 0;
};

// Choosing directions of light in proportion to what a surface does with them.

/// Where a path goes on from a point of a surface. Directions around its normal: half of them (all,
/// without a lobe) cosine-distributed, the others mirrored at half vectors from Beckmann's
/// distribution.
class BounceSampler {
  public:
    /// @param lobe_alpha  Beckmann slope parameter; 0: no lobe
    BounceSampler(const Eigen::Vector3d& normal, const Eigen::Vector3d& towards_viewer,
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

// The half vector between light and view, and Beckmann's distribution of it.

struct HalfVector {
    double cos_normal;  ///< with the surface normal
    double cos_light;   ///< with either direction
};

/// From cosines and relative azimuth (1 = mirror side, where the half vector is the normal).
HalfVector half_vector(double mu_in, double mu_out, double cos_azimuth);

/// Beckmann's density of facet normals per solid angle, exp(-tan^2/alpha^2) / (pi alpha^2 cos^4):
/// its integral times the cosine over the hemisphere is 1.
double beckmann_density(double cos_normal, double alpha);

}  // namespace miebrdf::render
