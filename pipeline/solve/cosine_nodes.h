// Where tables of functions of a cosine have their nodes: x in [0, 1] in even steps stands for
// sin^2(pi x / 2), so that nodes lie close to each other at both ends.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

namespace miebrdf {

inline double half_sine(double x) {
    const double sine = std::sin(0.5 * std::numbers::pi * x);
    return sine * sine;
}

/// half_sine at x = 0, 1/(count-1), ..., 1.
inline std::vector<double> half_sine_nodes(std::size_t count) {
    std::vector<double> nodes;
    nodes.reserve(count);
    for (std::size_t k = 0; k < count; ++k)
        nodes.push_back(half_sine(double(k) / double(count - 1)));
    return nodes;
}

/// Six neighbouring nodes and their Lagrange weights.
struct SixNodes {
    static constexpr std::size_t kCount = 6;

    SixNodes() = default;
    /// At a place in [0, count - 1], nodes being at 0, 1, 2, ...; a little beyond the ends it
    /// extrapolates.
    /// @param count  at least six
    SixNodes(double place, std::size_t count) {
        const double lowest = std::clamp(std::floor(place) - 2.0, 0.0, double(count - kCount));
        first = std::size_t(lowest);
        const double t = place - lowest;
        // 1 / product over i != j of (j - i).
        constexpr std::array<double, kCount> factor = {-1.0 / 120, 1.0 / 24,  -1.0 / 12,
                                                       1.0 / 12,   -1.0 / 24, 1.0 / 120};
        std::array<double, kCount> before = {1.0}, after = {};
        for (std::size_t j = 1; j < kCount; ++j) before[j] = before[j - 1] * (t - double(j - 1));
        after[kCount - 1] = 1.0;
        for (std::size_t j = kCount - 1; j-- > 0;) after[j] = after[j + 1] * (t - double(j + 1));
        for (std::size_t j = 0; j < kCount; ++j) weight[j] = factor[j] * before[j] * after[j];
    }

    /// The six of half_sine_nodes(count) around a share of [0, 1].
    static SixNodes of_share(double share, std::size_t count) {
        const double place = 2.0 / std::numbers::pi *
                             std::asin(std::sqrt(std::clamp(share, 0.0, 1.0))) * double(count - 1);
        // Rounding of sin and asin must not turn a node into something between nodes.
        const double nearest = std::round(place);
        const bool is_node = std::abs(place - nearest) < 1e-11 * double(count - 1);
        return {is_node ? nearest : place, count};
    }

    /// Any function given at the nodes.
    double of(const std::vector<double>& at_nodes) const {
        double sum = 0.0;
        for (std::size_t j = 0; j < kCount; ++j) sum += weight[j] * at_nodes[first + j];
        return sum;
    }

    std::size_t first = 0;
    std::array<double, kCount> weight = {};
};

/// Any function given at half_sine_nodes, between them.
inline double at_cosine(const std::vector<double>& at_nodes, double mu) {
    return SixNodes::of_share(mu, at_nodes.size()).of(at_nodes);
}

}  // namespace miebrdf
