// Glories and rainbows seen through a forward peak: the correction of the first order that delta-M
// needs, summed once and then read from a table.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "rte/math/chebyshev.h"
#include "rte/phase/scaled_medium.h"

namespace miebrdf::rte {

/// The coefficients of P_l(cos Theta), l = 0, 1, ..., in C of NarrowFeatures (below) at one
/// q = 1/mu_in + 1/mu_out; empty if there are none.
std::vector<double> narrow_strengths(const std::vector<ScaledMedium>& media, double q);

/// What the first order must change because light is diffracted before and after it is scattered:
/// C(q, Theta) / (4 (mu_in + mu_out)),
/// C = sum over media, sum_{l >= K} (2l+1) N_l P_l(cos Theta)
///     [G(F_l) - G(f) - s_l (G(F'_l) - G(f))],
/// with G the factor of a medium in the first order of scattering (q = 1/mu_in + 1/mu_out) when the
/// given fraction of every medium's scattering counts as none. The second part is what the discrete
/// equations know already: the share s_l of N_l, fed by what they keep of the peak, F'_l
/// (docs/maths-rte.md).
///
/// In log q, C is interpolated between Chebyshev points (it is made of exponentials of q). The
/// values there are of low rank: a few sums over l, functions of Theta, and for each a function of
/// q. The sums are done at every direction or, for many directions, tabulated.
///
/// Several stacks, one wavelength each, share what depends on directions alone.
class NarrowFeatures {
  public:
    /// Nothing to correct anywhere.
    NarrowFeatures() = default;

    /// @param stacks     of each the media from the bottom up, as for single_scattering
    /// @param mu_least   smallest cosine that will be asked for, in (0, 1]
    /// @param tolerance  of C, absolute
    NarrowFeatures(std::span<const std::vector<ScaledMedium>> stacks, double mu_least,
                   double tolerance);

    bool none() const { return strengths_.size() == 0; }
    std::size_t stacks() const { return stacks_; }

    /// Makes a table in Theta, which pays from some thousand directions on.
    void tabulate();

    /// What to add to R at all combinations of cosines, none below mu_least, and azimuths:
    /// reflection[((i * mu_out.size() + o) * cos_azimuth.size() + a) * stacks() + stack].
    void add_to(double* reflection, std::span<const double> mu_in, std::span<const double> mu_out,
                std::span<const double> cos_azimuth) const;

    /// Memory of one sum that the next one can use.
    struct Scratch {
        Eigen::VectorXd values, weights;
    };
    /// The same after tabulate() at one pair of cosines, where the angles of scattering are known:
    /// reflection[a * stacks() + stack].
    void add_at(double* reflection, double mu_in, double mu_out,
                std::span<const double> scattering_angles, Scratch& scratch) const;

  private:
    /// The coefficients of P_l at as many nodes in log q as the tolerance needs.
    void find_strengths(std::span<const std::vector<ScaledMedium>> stacks);
    /// As few functions of q in place of one for each node.
    void reduce_rank();
    void add_from_table(double* reflection, std::span<const double> mu_in,
                        std::span<const double> mu_out, std::span<const double> cos_azimuth) const;
    /// The functions of q.
    void weights_at(double q, Eigen::VectorXd& weights) const;

    std::size_t stacks_ = 0;
    double log_q_middle_ = 0.0;
    double log_q_half_ = 1.0;
    double tolerance_ = 0.0;
    math::ChebyshevPoints nodes_;
    Eigen::MatrixXd at_nodes_;   ///< functions of q (columns) at the nodes (rows)
    Eigen::MatrixXd strengths_;  ///< row = function of q * stacks + stack, column = degree
    std::optional<math::AngleTable> table_;  ///< one function for each row of strengths
};

}  // namespace miebrdf::rte
