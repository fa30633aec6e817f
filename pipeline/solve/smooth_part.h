// Light scattered more than once: smooth enough to be tabulated over cosines and azimuthal orders.
#pragma once

#include <cstddef>
#include <vector>

namespace miebrdf {

/// (mu_in + mu_out) R^m on the cosines sin^2(pi x / 2), x = 0, 1/48, ..., 1, interpolated between
/// them in x by sixth-order Lagrange polynomials; at these cosines nothing is interpolated.
class SmoothPart {
  public:
    static constexpr std::size_t kNodes = 49;

    /// The cosines, ascending; the first stands for the horizon.
    static const std::vector<double>& nodes();

    /// Nothing: R = 0.
    SmoothPart() = default;
    /// @param modes  [(in * kNodes + out) * orders + m]: (mu_in + mu_out) a_m with
    ///               R = a_0 + sum a_m cos(m azimuth)
    SmoothPart(std::vector<double> modes, std::size_t orders);

    /// Multiplies by in(mu_in) out(mu_out), both given at the nodes.
    void scale(const std::vector<double>& in, const std::vector<double>& out);
    /// Adds `weight` times another table.
    void add(const SmoothPart& other, double weight);

    /// The coefficients a_m at a pair of cosines; at least one.
    void series_at(double mu_in, double mu_out, std::vector<double>& series) const;

  private:
    std::size_t orders_ = 0;
    std::vector<double> modes_;
};

/// Any function given at the nodes, between them.
double at_cosine(const std::vector<double>& at_nodes, double mu);

/// a_0 + sum a_m cos(m azimuth) by Clenshaw's recurrence.
double cosine_sum(const std::vector<double>& a, double cos_azimuth);

}  // namespace miebrdf
