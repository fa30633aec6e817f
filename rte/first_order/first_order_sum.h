// Adds light scattered once to sums over Fourier orders.
#pragma once

#include <cstddef>
#include <limits>
#include <vector>

#include "rte/first_order/first_order.h"

namespace miebrdf::rte {

/// Whether light comes back within so many degrees of where it came from.
/// Order: [(in * mu_out.size() + out) * azimuth_deg.size() + azimuth]
std::vector<bool> near_retro_reflection(const Directions& directions, double within_deg);

/// Adds what is scattered once to reflection functions or Mueller matrices: exactly, or as the
/// discrete equations see it, by SolverOptions::single_scattering_correction. Of a rough boundary
/// it adds the lobe that one facet reflects, and the one that mirrors below send back through it.
///
/// Exact phase functions do not depend on the number of nodes, nor does what their narrow features
/// scatter from degrees on that delta-M cuts off: both are evaluated once, at the first call, and
/// kept (8 bytes for each direction, and for each medium as many, or 48 of a matrix).
class FirstOrderSum {
  public:
    /// @param directions  in air; must outlive this
    /// @param components  of light: 1 (numbers), 3 or 4 (matrices)
    /// @param shown       c, of the matrices: as many, or 1 for element 11 alone
    FirstOrderSum(const Directions& directions, const SolverOptions& options, int components,
                  int shown);
    FirstOrderSum(const Directions& directions, const SolverOptions& options)
        : FirstOrderSum(directions, options, 1, 1) {}

    /// @param reflection  [((in * mu_out.size() + out) * c^2 + row * c + column) *
    ///                    azimuth_deg.size() + azimuth], added to
    /// @param stack       the same at every call; delta-M may differ
    void add_to(std::vector<double>& reflection, const ScaledStack& stack);

  private:
    /// P or F of each medium at each direction, [medium * directions + direction].
    struct Scattered {
        std::vector<double> phase;
        std::vector<ScatteringMatrix> matrix;
    };
    std::size_t pairs() const { return directions_.mu_in.size() * directions_.mu_out.size(); }
    void add_outer_lobe(std::vector<double>& reflection, const ScaledStack& stack) const;
    void evaluate(const FirstOrder& first_order);
    /// The change by narrow features, without the boundary.
    std::vector<double> narrow_change(const FirstOrder& first_order);
    /// Whether these media, too, have what is kept.
    bool has_kept_narrow(const std::vector<ScaledMedium>& media) const;
    void keep_narrow(const std::vector<ScaledMedium>& media);

    const Directions& directions_;
    bool is_polarised_;
    int shown_;
    SolverOptions options_;
    std::vector<double> cos_azimuth_;
    Directions inside_;  ///< as straight light has them in the medium
    double mu_least_ = 1.0;
    Scattered back_, forward_;
    bool narrow_is_known_ = false;
    /// Narrow features from this degree on are kept.
    int first_kept_ = std::numeric_limits<int>::max();
    std::vector<ForwardPeak> kept_;     ///< of each medium, from that degree on
    std::vector<double> narrow_;        ///< what they scatter, at each direction; none: empty
    std::vector<double> narrow_phase_;  ///< and their part of P, as Scattered::phase
};

}  // namespace miebrdf::rte
