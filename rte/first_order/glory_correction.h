// Glories and rainbows seen through a forward peak: the correction of the first order that delta-M
// needs, summed once and then read from a table.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "rte/math/chebyshev.h"
#include "rte/phase/scaled_medium.h"

namespace miebrdf::rte {

/// The shares of P_l, l = 0 ... degrees - 1, near retro-reflection that nodes do not resolve:
/// [degree][angle of zenith, kResolvedAngles of them].
/// @param resolved_waves  by the nodes, at these angles; empty: everything is resolved
std::vector<double> unresolved_shares(const std::vector<double>& resolved_waves, int degrees);

/// Those below `end`.
struct DegreeRange {
    int first = 0;
    int end = std::numeric_limits<int>::max();
};

/// The degrees among these that narrow features of the media have; an empty range if none do.
DegreeRange narrow_degrees(const std::vector<ScaledMedium>& media, const DegreeRange& wanted = {});

/// Which sum over the degrees of narrow features.
enum class NarrowSum {
    correction,  ///< C of GloryCorrection
    features     ///< sum over media, sum_l (2l+1) N_l P_l G(F_l): no nodes and no delta-M in it
};

/// sum_l (2l+1) N_l P_l of each medium (column) at the angles (row), from the given degree on.
/// @param tolerance  absolute; of a table in angle, which pays from some thousand of them on
Eigen::MatrixXd narrow_phase(const std::vector<ScaledMedium>& media, int first_degree,
                             const Eigen::VectorXd& angles, double tolerance);

/// True if so many directions or angles are worth a table.
bool worth_a_table(std::size_t directions);

/// The part of each degree in C of GloryCorrection (below) for the media of one stack: all that
/// does not depend on q = 1/mu_in + 1/mu_out is computed once.
class GloryStrengths {
  public:
    /// @param media    from the bottom up, as for single_scattering
    /// @param degrees  that are summed; none of others
    explicit GloryStrengths(const std::vector<ScaledMedium>& media, const DegreeRange& degrees = {},
                            NarrowSum sum = NarrowSum::correction);

    /// The coefficients of P_l(cos Theta), l = 0, 1, ..., in C at one q; empty if there are none.
    Eigen::VectorXd of_all(double q) const;
    /// [degree][angle of zenith, kResolvedAngles of them]: coefficients of P_l in what the nodes do
    /// not resolve of that, of the half of the light that is scattered forward at this angle.
    Eigen::VectorXd of_unresolved(double q) const;

  private:
    /// One medium, its lists from degree first_ on.
    struct Medium {
        double scaled_optical_depth = 0.0;
        double depth_factor = 1.0;
        Eigen::ArrayXd strength;  ///< alpha (2l+1) N_l
        /// The loss of light when F_l of the scattering counts as none, relative to that by
        /// delta-M.
        Eigen::ArrayXd loss;
        Eigen::ArrayXd loss_of_kept;  ///< the same with what the discrete equations keep of F_l
        Eigen::ArrayXd share_kept;    ///< of N_l in the discrete equations
        std::vector<double> unresolved_shares;
    };
    /// Calls visit(medium, G(F_l) - G(f) of so many degrees, G(F'_l) - G(f), G(f)) from the top
    /// down.
    template <typename Visit>
    void for_each_medium(double q, Eigen::Index degrees, const Visit& visit) const;

    NarrowSum sum_;
    int first_ = 0;
    Eigen::Index count_ = 0, kept_ = 0;  ///< degrees; of these below the cutoff of any medium
    std::vector<Medium> media_;          ///< from the top down
};

/// How much of R straight back towards the light, along the cosine mu in the media, is a glory of
/// light scattered once, seen through the forward peaks, times the share of its degrees that the
/// nodes do not resolve.
/// @param media  as split_by_resolution leaves them
double unresolved_glory(const std::vector<ScaledMedium>& media, double mu);

/// The first order must change because light is diffracted before and after it is scattered, by
/// C(q, Theta) / (4 (mu_in + mu_out)),
/// C = sum over media, sum_{l >= K} (2l+1) N_l P_l(cos Theta)
///     [G(F_l) - G(f) - s_l (G(F'_l) - G(f))],
/// with G the factor of a medium in the first order of scattering (q = 1/mu_in + 1/mu_out) when the
/// given fraction of every medium's scattering counts as none. The second part is what the discrete
/// equations know already: the share s_l of N_l, fed by what they keep of the peak, F'_l
/// (docs/maths-rte.md).
///
/// Where the media know what their nodes resolve (ScaledMedium::unresolved_shares), what these do
/// not is added: it depends on both cosines, and is known but roughly away from retro-reflection.
///
/// In log q, C is interpolated between Chebyshev points (it is made of exponentials of q). The
/// values there are of low rank: a few sums over l, functions of Theta, and for each a function of
/// q. The sums are done at every direction or, for many directions, tabulated.
///
/// Several stacks, one wavelength each, share what depends on directions alone.
class GloryCorrection {
  public:
    /// Nothing to correct anywhere.
    GloryCorrection() = default;

    /// @param stacks     of each the media from the bottom up, as for single_scattering
    /// @param mu_least   smallest cosine that will be asked for, in (0, 1]
    /// @param tolerance  of C, absolute
    /// @param degrees    that are summed; none of others
    GloryCorrection(std::span<const std::vector<ScaledMedium>> stacks, double mu_least,
                    double tolerance, const DegreeRange& degrees = {},
                    NarrowSum sum = NarrowSum::correction);

    bool none() const { return strengths_.size() == 0; }
    std::size_t stacks() const { return stacks_; }

    /// Makes a table in Theta (worth_a_table).
    void tabulate();

    /// Adds the correction to R at all combinations of cosines, none below mu_least, and azimuths:
    /// reflection[((i * mu_out.size() + o) * cos_azimuth.size() + a) * stacks() + stack].
    void add_to(double* reflection, std::span<const double> mu_in, std::span<const double> mu_out,
                std::span<const double> cos_azimuth) const;

    /// Memory of one sum that the next one can use.
    struct Scratch {
        Eigen::VectorXd values, weights;
    };
    /// Adds it after tabulate() at one pair of cosines, where the angles of scattering are known:
    /// reflection[a * stacks() + stack].
    void add_at(double* reflection, double mu_in, double mu_out,
                std::span<const double> scattering_angles, Scratch& scratch) const;

  private:
    /// Functions of q, by Chebyshev points in log q, and the coefficients of P_l of each.
    struct SlantFunctions {
        math::ChebyshevPoints nodes;
        Eigen::MatrixXd at_nodes;   ///< functions of q (columns) at the nodes (rows)
        Eigen::MatrixXd strengths;  ///< row = function * stacks + stack, column = degree
        Eigen::VectorXd at(double t) const;
    };
    using Strengths = std::function<Eigen::VectorXd(const GloryStrengths&, double q)>;
    /// With as many nodes as the tolerance needs, and as few functions of them as that allows.
    /// @param one_q  the strengths do not depend on q
    SlantFunctions slant_functions(const std::vector<GloryStrengths>& stacks, bool one_q,
                                   const Strengths& strengths, double tolerance) const;
    /// Adds what the nodes do not resolve, with functions of q and of both cosines.
    void add_unresolved(const std::vector<GloryStrengths>& stacks, bool one_q);
    void add_from_table(double* reflection, std::span<const double> mu_in,
                        std::span<const double> mu_out, std::span<const double> cos_azimuth) const;
    /// The functions of a pair of cosines, divided by 4 (mu_in + mu_out).
    void weights_at(double mu_in, double mu_out, Eigen::VectorXd& weights) const;

    std::size_t stacks_ = 0;
    double log_q_middle_ = 0.0;
    double log_q_half_ = 1.0;
    double tolerance_ = 0.0;
    SlantFunctions known_;       ///< of the sum over all degrees beyond delta-M
    SlantFunctions unresolved_;  ///< of degrees in the discrete equations, strengths not kept
    Eigen::MatrixXd at_pairs_;   ///< functions (columns) at angles of zenith and functions of q
    Eigen::MatrixXd strengths_;  ///< row = function * stacks + stack, column = degree
    std::optional<math::AngleTable> table_;  ///< one function for each row of strengths
};

}  // namespace miebrdf::rte
