// A solved BRDF made small: what a report page carries, and what it evaluates at any directions.
#pragma once

#include <miebrdf/brdf.h>

#include <optional>
#include <vector>

#include "pipeline/report/low_rank.h"

namespace miebrdf::report {

/// The lobe of a rough surface or boundary, taken apart: f = D(h) G F / (4 mu_in mu_out) s_in
/// s_out.
struct PageLobe {
    bool ggx = false;    ///< else Beckmann
    double alpha = 0.3;  ///< slope parameter
    rte::Shadowing shadowing = rte::Shadowing::smith_correlated;
    std::vector<double> masking;               ///< mu / G1(mu) at the nodes
    std::vector<std::vector<double>> fresnel;  ///< [wavelength], cosine of incidence at the nodes
    std::vector<std::vector<double>> scale;    ///< [wavelength], s at the nodes; empty: 1
    /// It stands for the mirror reflection of a smooth boundary: in pictures only, no part of f.
    bool only_in_pictures = false;
};

/// BrdfTable in a hundredth of its size.
///
/// Light scattered more than once: (mu_in + mu_out) R as Fourier series in azimuth at pairs of
/// cosines (half_sine_nodes), mu_in <= mu_out, because it is reciprocal. Light scattered once:
/// 4 (mu_in + mu_out) R as a table of the scattering angle and of q = 1/mu_in + 1/mu_out; under
/// boundaries and over mirrors it is in the series. Both keep few basis columns (LowRank). What a
/// surface lets in and out, and its lobe, are functions of cosines.
class PageTable {
  public:
    /// Nodes of functions of one cosine.
    static constexpr int kCosines = 49;
    /// Of log q, from q = kFirstQ to kLastQ, where more than one layer makes it matter.
    static constexpr int kSlants = 33;
    static constexpr double kFirstQ = 2.0, kLastQ = 2000.0;

    /// Makes the smallest table whose interpolation is within `tolerance`, or the finest there is.
    /// @throws InputError  when a wavelength has no physical solution; Cancelled
    PageTable(const BrdfTable& table, double tolerance, const Control& control);

    std::size_t wavelengths() const { return wavelengths_; }
    /// BRDF [1/sr] at each wavelength, as the page evaluates it.
    void evaluate(const Direction& direction, std::vector<double>& brdf) const;
    /// The same without the lobe of a surface.
    void evaluate_layers(const Direction& direction, std::vector<double>& brdf) const;
    /// Share that a surface lets in.
    double let_in(std::size_t wavelength, double mu) const;
    /// Largest difference from the BRDF it was made of, over directions between the nodes, relative
    /// to the largest value at that incidence and wavelength.
    double interpolation_error() const { return error_; }

    // What the page is given.
    int pair_cosines() const { return pair_cosines_; }
    /// Fourier orders of each pair (i, o >= i), in this order.
    const std::vector<int>& orders() const { return orders_; }
    const LowRank& multiple() const { return multiple_; }  ///< row = pair, order
    int angles() const { return angles_; }                 ///< 0: all is in the series
    int slants() const { return slants_; }                 ///< 1: q does not matter
    const LowRank& once() const { return once_; }  ///< column = slant * wavelengths() + wavelength
    /// Shares that a surface lets in and out, [wavelength] at the nodes; empty: all of it.
    const std::vector<std::vector<double>>& in() const { return in_; }
    const std::vector<std::vector<double>>& out() const { return out_; }
    const std::optional<PageLobe>& lobe() const { return lobe_; }

  private:
    void add_surface(const BrdfTable::State& state);
    void add_boundary(const BrdfTable::State& state);
    void add_once(const BrdfTable::State& state, const Control& control);
    void add_multiple(const BrdfTable::State& state, int cosines, const Control& control);
    /// @param series  [wavelength][pair], (mu_in + mu_out) times the coefficients
    void keep_orders(const std::vector<std::vector<std::vector<double>>>& series, int cosines);
    void add_lobe(const Direction& direction, std::vector<double>& brdf) const;
    Eigen::VectorXd scattered_once(const Direction& direction) const;
    Eigen::VectorXd scattered_more(const Direction& direction) const;
    double measure(const BrdfTable& table) const;

    std::size_t wavelengths_ = 0;
    int pair_cosines_ = 0;
    std::vector<int> orders_, first_row_;
    LowRank multiple_;
    int angles_ = 0, slants_ = 1;
    LowRank once_;
    std::vector<std::vector<double>> in_, out_;
    std::optional<PageLobe> lobe_;
    double error_ = 0.0;
};

}  // namespace miebrdf::report
