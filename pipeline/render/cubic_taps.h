// Cubic interpolation in a table: which four neighbours, and how much of each.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

namespace miebrdf::render {

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

}  // namespace miebrdf::render
