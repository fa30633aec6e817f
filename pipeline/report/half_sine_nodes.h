// Where the tables of a report have their nodes: x in [0, 1] in even steps stands for sin^2(pi x/2)
// of a range, so that nodes lie close to each other at both ends of it.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

namespace miebrdf::report {

inline double half_sine(double x) {
    const double sine = std::sin(0.5 * std::numbers::pi * x);
    return sine * sine;
}
inline double half_sine_place(double share) {
    return 2.0 / std::numbers::pi * std::asin(std::sqrt(std::clamp(share, 0.0, 1.0)));
}

/// sin^2(pi x / 2) at x = 0, 1/(count-1), ..., 1.
inline std::vector<double> half_sine_nodes(int count) {
    std::vector<double> nodes;
    nodes.reserve(std::size_t(count));
    for (int k = 0; k < count; ++k) nodes.push_back(half_sine(double(k) / (count - 1)));
    return nodes;
}

/// Six neighbouring nodes and their Lagrange weights at a place in [0, count - 1], nodes being at
/// 0, 1, 2, ...; a little beyond the ends it extrapolates. At least six nodes.
struct SixNodes {
    int first = 0;
    std::array<double, 6> weight = {};
};

inline SixNodes six_nodes(double place, int count) {
    SixNodes six;
    six.first = std::clamp(int(std::floor(place)) - 2, 0, count - 6);
    const double t = place - six.first;
    for (int i = 0; i < 6; ++i) {
        double weight = 1.0;
        for (int j = 0; j < 6; ++j) {
            if (j != i) weight *= (t - j) / (i - j);
        }
        six.weight[std::size_t(i)] = weight;
    }
    return six;
}

}  // namespace miebrdf::report
