// SmoothPart: light scattered more than once, tabulated over cosines and Fourier orders; and the
// nodes and interpolation of tables over a cosine.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <vector>

#include "rte/math/cosine_series.h"

namespace miebrdf {

/// Nodes of a table over a cosine in [0, 1] are half_sine(k / (count - 1)) = sin^2(pi x / 2): they
/// lie close to each other at both ends.
inline double half_sine(double x) {
    const double sine = std::sin(0.5 * std::numbers::pi * x);
    return sine * sine;
}

inline std::vector<double> half_sine_nodes(std::size_t count) {
    std::vector<double> nodes;
    nodes.reserve(count);
    for (std::size_t k = 0; k < count; ++k)
        nodes.push_back(half_sine(double(k) / double(count - 1)));
    return nodes;
}

/// Azimuths at which R is sampled for its Fourier series: cosines of 180 j / n degrees, j = 0 ...
/// n.
std::vector<double> cosines_of_azimuths(int n);
/// Number of orders that these samples resolve: m < 3n/4. Orders m and 2n - m are alike at all of
/// them, so that the highest ones have the light of orders beyond n.
constexpr int resolved_orders(int n) { return 3 * n / 4; }
/// Row of samples x this = row of the resolved orders a_m, R = sum_m a_m cos(m azimuth).
Eigen::MatrixXd samples_to_orders(int n);

/// Six neighbouring nodes and their Lagrange weights.
struct SixNodes {
    static constexpr std::size_t kCount = 6;

    SixNodes() = default;
    /// @param place  in [0, count - 1], in units of the nodes' distance; slightly outside it
    ///               extrapolates
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

    /// The six of half_sine_nodes(count) around a value in [0, 1].
    static SixNodes around(double value, std::size_t count) {
        const double place = 2.0 / std::numbers::pi *
                             std::asin(std::sqrt(std::clamp(value, 0.0, 1.0))) * double(count - 1);
        // A value within rounding of a node counts as the node.
        const double nearest = std::round(place);
        const bool is_node = std::abs(place - nearest) < 1e-11 * double(count - 1);
        return {is_node ? nearest : place, count};
    }

    /// Interpolates a function given at the nodes.
    double of(const std::vector<double>& at_nodes) const {
        double sum = 0.0;
        for (std::size_t j = 0; j < kCount; ++j) sum += weight[j] * at_nodes[first + j];
        return sum;
    }

    std::size_t first = 0;
    std::array<double, kCount> weight = {};
};

/// Interpolates a function given at half_sine_nodes.
inline double at_cosine(const std::vector<double>& at_nodes, double mu) {
    return SixNodes::around(mu, at_nodes.size()).of(at_nodes);
}

/// (mu_in + mu_out) R^m at pairs of 49 half_sine_nodes, interpolated between them (SixNodes). Kept
/// in single precision (1e-7 of a pair's largest order), because interpolation is seldom better
/// than 1e-6.
class SmoothPart {
  public:
    static constexpr std::size_t kNodes = 49;
    /// Number of orders summed at a time.
    static constexpr std::size_t kLanes = math::kSeriesLanes;

    /// The cosines, ascending; the first stands for the horizon.
    static const std::vector<double>& nodes();

    static SixNodes place_of(double mu) { return SixNodes::around(mu, kNodes); }

    /// R = 0.
    SmoothPart() = default;
    /// @param modes  (mu_in + mu_out) a_m, R = sum_m a_m cos(m azimuth), at
    ///               [(in * kNodes + out) * orders + m]. The last orders of a pair become 0 where
    ///               their sum is less than 1e-7 of all: near the vertical few are left
    SmoothPart(const std::vector<double>& modes, std::size_t orders);

    /// Multiplies by in(mu_in) out(mu_out), given at the nodes.
    void scale(const std::vector<double>& in, const std::vector<double>& out);
    /// Adds `weight` times another table.
    void add(const SmoothPart& other, double weight);

    /// The coefficients a_m at a pair of cosines; zeros fill them up to a multiple of kLanes.
    void series_at(double mu_in, double mu_out, std::vector<double>& series) const;
    /// The same for a caller that has found the nodes once for many wavelengths.
    /// @param in, out  place_of() the cosines
    /// @param mu_sum   mu_in + mu_out
    void series_at(const SixNodes& in, const SixNodes& out, double mu_sum,
                   std::vector<double>& series) const;

  private:
    /// The number of places of six neighbouring nodes.
    static constexpr std::size_t kPlaces = kNodes - SixNodes::kCount + 1;
    void count_needed();

    std::size_t orders_ = 0;  ///< a multiple of kLanes
    std::vector<float> modes_;
    std::vector<std::uint32_t> needed_;  ///< orders that matter, [first_in * kPlaces + first_out]
};

}  // namespace miebrdf
