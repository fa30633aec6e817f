// Coordinates for integrals over the slopes of a rough surface in which their density is smooth and
// bounded: the lobe has the same shape for every roughness.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

namespace miebrdf::rte {

/// Gaussian slopes in units of alpha: x = alpha u, y = alpha v. Beyond the cut their density is
/// below 4e-17 of its peak.
struct BeckmannSlopes {
    static constexpr double kCut = 6.2;
    static constexpr double kLargest = kCut;  ///< of u and v
    double alpha;
    double across_of(double y) const { return std::min(y / alpha, kCut); }
    double y(double v) const { return alpha * v; }
    double across_density(double v) const { return std::numbers::inv_sqrtpi * std::exp(-v * v); }
    double along_of(double x, double) const { return std::clamp(x / alpha, -kCut, kCut); }
    double x(double u, double) const { return alpha * u; }
    double along_density(double u) const { return std::numbers::inv_sqrtpi * std::exp(-u * u); }
};

/// GGX slopes as two angles: y = alpha tan(v), x = alpha tan(u) / cos(v) makes
/// P dx dy = cos(v) cos^2(u) / pi du dv, tails included.
struct GgxSlopes {
    static constexpr double kLargest = 0.5 * std::numbers::pi;
    double alpha;
    double across_of(double y) const { return std::atan(y / alpha); }
    double y(double v) const { return alpha * std::tan(v); }
    double across_density(double v) const { return std::cos(v); }
    double along_of(double x, double v) const { return std::atan(x * std::cos(v) / alpha); }
    double x(double u, double v) const { return alpha * std::tan(u) / std::cos(v); }
    double along_density(double u) const {
        return std::numbers::inv_pi * std::cos(u) * std::cos(u);
    }
};

}  // namespace miebrdf::rte
