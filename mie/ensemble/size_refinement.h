// Averages over sizes to a tolerance: one rule for spheres, coated spheres, spheroids and tables of
// sizes, and for moments, scattering matrices and P.
#pragma once

#include <Eigen/Core>

#include "mie/ensemble/particle_ensemble.h"
#include "mie/ensemble/size_sums.h"
#include "mie/sizes/size_nodes.h"

namespace miebrdf::mie {

/// The rule that says which sizes are summed and what their average errs by. Its numbers were
/// chosen on 320 random ensembles, and judged on 640 others (docs/internals/constants.md).
///
/// Smooth in size: Gauss nodes in ln r, n = 16, 32, ... 128:
///     error = 2 |G_n - G_2n|.
/// With narrow resonances: N = 64, 128, ... equally spaced sizes, seen as four interleaved lattices
/// of N/4 sizes. A doubling merges the four in pairs and adds two new ones, so that every sphere
/// counts. T_N is the mean of all, s the standard error that follows from the scatter of the four:
///     error = 2 max(|T_N - T_N/2| of all, s of q_ext, albedo and g, 2 s of ln(1 - albedo)).
/// Moments that err by less than AverageLimits::kPartShare of the tolerance are not summed any
/// more. The change by a doubling is one random number, and small by chance in one case of ten; the
/// scatter of the four is three more of them for nothing.
struct SizeRule {
    /// Smooth: light is damped by exp(-4 k x) through the middle, k x_eff > kSmoothDamping, or even
    /// the largest sphere, of a size parameter below kSmallSphere, has no narrow resonance.
    static constexpr double kSmoothDamping = 0.25, kSmallSphere = 3;
    static constexpr int kFirstGauss = 16, kMostGauss = 128;
    /// Most: transparent spheres stop near 1e-6 there.
    static constexpr int kFirstEven = 64, kMostEven = 1 << 16;
    /// The 2 of both errors; the 2 of s of ln(1 - albedo).
    static constexpr double kSafety = 2, kAbsorptionScatter = 2;
};

/// Sums over sizes of one kind of particle, and what is made of them.
class SizeSummation {
  public:
    virtual ~SizeSummation() = default;
    /// @param nodes  ascending
    /// @param all    of everything; otherwise efficiencies and g alone
    virtual SizeSums sum(const SizeNodes& nodes, bool all) const = 0;
    /// Moments, coefficients of the matrix, or P.
    virtual Eigen::ArrayXd averages(const SizeSums& sums) const = 0;
    /// The relative change of q_ext that counts as much as this change of the averages.
    virtual double size_of(const Eigen::ArrayXd& change, const Eigen::ArrayXd& /*averages*/,
                           const SphereSums& /*sums*/) const {
        return change.size() > 0 ? change.abs().maxCoeff() : 0.0;
    }
    /// The error that is wanted, by what is known so far.
    virtual double tolerance(const SphereSums& sums) const = 0;
};

/// An average over sizes.
struct RefinedAverage {
    SizeSums sums;
    Eigen::ArrayXd averages, change;  ///< the last change of each average; empty: none
    double error_estimate = 0;
    int sizes = 0;  ///< of the average, without those of Gauss rules that were not enough
    bool is_smooth = true;
};

/// @param tolerance   that is not worth equally spaced sizes beyond Gauss nodes
/// @param most_sizes  of equally spaced ones, where time is limited
RefinedAverage refine_sizes(const Ensemble& ensemble, const SizeSummation& summation,
                            double tolerance, int most_sizes = SizeRule::kMostEven);

/// Whether efficiencies are smooth in size.
bool is_smooth_in_size(const Ensemble& ensemble);

/// Efficiencies, albedo and g of sums over the sizes of a range that has this share of the area.
EnsembleOptics efficiencies_of(const SphereSums& sums, double share);

}  // namespace miebrdf::mie
