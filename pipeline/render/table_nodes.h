// Where the solver is asked, and how to find these places again.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "pipeline/render/cubic_taps.h"

namespace miebrdf::render {

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
