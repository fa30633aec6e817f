// Light scattered more than once: smooth enough to be tabulated over cosines and azimuthal orders.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "pipeline/solve/cosine_nodes.h"
#include "rte/math/cosine_series.h"

namespace miebrdf {

/// (mu_in + mu_out) R^m on 49 half_sine_nodes, interpolated between them by sixth-order Lagrange
/// polynomials (SixNodes); at these cosines nothing is interpolated. Kept in
/// single precision: 1e-7 of a pair's largest order, where interpolation is seldom better than
/// 1e-6.
class SmoothPart {
  public:
    static constexpr std::size_t kNodes = 49;
    /// Orders are summed so many at a time.
    static constexpr std::size_t kLanes = math::kSeriesLanes;

    /// The cosines, ascending; the first stands for the horizon.
    static const std::vector<double>& nodes();

    static SixNodes place_of(double mu) { return SixNodes::of_share(mu, kNodes); }

    /// Nothing: R = 0.
    SmoothPart() = default;
    /// @param modes  [(in * kNodes + out) * orders + m]: (mu_in + mu_out) a_m with
    ///               R = a_0 + sum a_m cos(m azimuth); the last orders of a pair are taken as 0
    ///               where they add up to less than 1e-7 of all: near the vertical few are left
    SmoothPart(const std::vector<double>& modes, std::size_t orders);

    /// Multiplies by in(mu_in) out(mu_out), both given at the nodes.
    void scale(const std::vector<double>& in, const std::vector<double>& out);
    /// Adds `weight` times another table.
    void add(const SmoothPart& other, double weight);

    /// The coefficients a_m at a pair of cosines, filled up with zeros to a multiple of kLanes.
    void series_at(double mu_in, double mu_out, std::vector<double>& series) const;
    /// The coefficients for places (place_of) that are known; many wavelengths share them.
    /// @param mu_sum  mu_in + mu_out
    void series_at(const SixNodes& in, const SixNodes& out, double mu_sum,
                   std::vector<double>& series) const;

  private:
    static constexpr std::size_t kStencils = kNodes - SixNodes::kCount + 1;
    void count_needed();

    std::size_t orders_ = 0;  ///< a multiple of kLanes, filled up with zeros
    std::vector<float> modes_;
    std::vector<std::uint32_t> needed_;  ///< orders that matter, [first_in * kStencils + first_out]
};

}  // namespace miebrdf
