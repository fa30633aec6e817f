// Cubic interpolation in a table: which four neighbours, and how much of each.
#pragma once

#include <array>
#include <cstddef>
#include <span>

namespace miebrdf::render {

/// value(x) = sum of weight[k] * table[first + k]: Lagrange's cubic through the four nearest nodes,
/// one-sided at the ends.
struct CubicTaps {
    std::size_t first = 0;
    std::array<double, 4> weight{};
};

/// Nodes 0, 1, ..., count - 1 (at least 4); x is kept within them.
CubicTaps uniform_taps(double x, std::size_t count);

/// @param nodes  ascending, at least 4; x is kept within them
CubicTaps taps_at(double x, std::span<const double> nodes);

}  // namespace miebrdf::render
