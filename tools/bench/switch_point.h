// Finds where a method hands over to another, and how far the result jumps there.
#pragma once

#include <cmath>
#include <functional>
#include <utility>
#include <vector>

namespace miebrdf::bench {

/// Two neighbouring values of a parameter with different methods (or grids) behind them.
struct SwitchPoint {
    double below = 0.0;
    double above = 0.0;
};

/// All places between `from` and `to` where `state` changes, as seen by `steps` steps of equal
/// ratio; each halved until the two sides are neighbouring doubles.
/// @param from, to  positive
inline std::vector<SwitchPoint> find_switches(double from, double to, int steps,
                                              const std::function<long(double)>& state) {
    std::vector<SwitchPoint> found;
    double below = from;
    long before = state(from);
    for (int i = 1; i <= steps; ++i) {
        const double above = from * std::pow(to / from, double(i) / steps);
        const long after = state(above);
        SwitchPoint point{below, above};
        below = above;
        if (after == std::exchange(before, after)) continue;
        const long left = state(point.below);
        for (double middle = 0.5 * (point.below + point.above);
             middle > point.below && middle < point.above;
             middle = 0.5 * (point.below + point.above)) {
            (state(middle) == left ? point.below : point.above) = middle;
        }
        found.push_back(point);
    }
    return found;
}

}  // namespace miebrdf::bench
