// Tables for rays: where the solver is asked, how these places are found again, and sixteen
// wavelengths at a time (a register of AVX-512, two of AVX2).
#pragma once

#include <Eigen/Core>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

namespace miebrdf::render {

/// Single precision: relative rounding of 1e-7 is far below what interpolation loses.
using Lane = Eigen::Array<float, 16, 1>;
inline constexpr std::size_t kLaneWidth = 16;

inline std::size_t lanes_for(std::size_t wavelengths) {
    return (wavelengths + kLaneWidth - 1) / kLaneWidth;
}

inline Eigen::Map<const Lane> lane_at(const float* values) {
    return Eigen::Map<const Lane>(values);
}

// Cubic interpolation in a table: which four neighbours, and how much of each.

/// value(x) = sum of weight[k] * table[first + k]: Lagrange's cubic through the four nearest nodes,
/// one-sided at the ends.
struct CubicTaps {
    std::size_t first = 0;
    std::array<float, 4> weight{};
};

/// Nodes 0, 1, ..., count - 1 (at least 4); x is kept within them.
inline CubicTaps uniform_taps(double x, std::size_t count) {
    const double at = std::clamp(x, 0.0, double(count - 1));
    CubicTaps taps;
    taps.first = std::clamp<std::size_t>(std::size_t(at), 1, count - 3) - 1;
    const double t = at - double(taps.first);  // nodes at 0, 1, 2, 3
    const double a = t, b = t - 1, c = t - 2, d = t - 3;
    taps.weight = {float(b * c * d / -6), float(a * c * d / 2), float(a * b * d / -2),
                   float(a * b * c / 6)};
    return taps;
}

/// A lane of a table whose rows, `stride` apart, are spectra.
/// @param rows  the lane in the first row
inline Lane interpolate(const float* rows, std::size_t stride, const CubicTaps& taps) {
    const float* first = rows + taps.first * stride;
    return taps.weight[0] * lane_at(first) + taps.weight[1] * lane_at(first + stride) +
           taps.weight[2] * lane_at(first + 2 * stride) +
           taps.weight[3] * lane_at(first + 3 * stride);
}

// Where the solver is asked, and how to find these places again.

/// Maps [0, 1] onto itself, steep like a square root at both ends: nodes spaced evenly in
/// spread(y) lie dense there. Roots alone, because a place in a table is sought for every ray.
inline double spread(double y) { return 0.5 * (1.0 + std::sqrt(y) - std::sqrt(1.0 - y)); }
double spread_inverse(double x);

/// From 0 to 1 as an angle grows from 0 to pi; its slope varies by no more than 2.
inline double share_of_angle(double cosine) {
    const double s = std::sqrt(std::max(0.0, 1.0 - cosine));  // sin, cos of half the angle, times
    const double c = std::sqrt(std::max(0.0, 1.0 + cosine));  // sqrt(2)
    return s / (s + c);
}

/// Cosines with spread(mu) spaced evenly, the first 1e-9: close to each other at grazing, where
/// reflection changes fastest, and at the normal.
std::vector<double> cosine_nodes(int count);
inline CubicTaps cosine_taps(double mu, std::size_t count) {
    return uniform_taps(spread(mu) * double(count - 1), count);
}

/// Azimuths from 0 to 180 degrees, evenly spaced in share_of_angle^(3/4): closer on the forward
/// side, where peaked phase functions make even multiple scattering narrow at grazing.
std::vector<double> azimuth_nodes_deg(int count);
inline CubicTaps azimuth_taps(double cos_azimuth, std::size_t count) {
    const double y = share_of_angle(cos_azimuth);
    return uniform_taps(std::sqrt(y * std::sqrt(y)) * double(count - 1), count);
}

/// Scattering angles in radians, evenly spaced in spread(share_of_angle).
std::vector<double> scattering_angle_nodes(int count);
inline CubicTaps scattering_angle_taps(double cos_theta, std::size_t count) {
    return uniform_taps(spread(share_of_angle(cos_theta)) * double(count - 1), count);
}

}  // namespace miebrdf::render
