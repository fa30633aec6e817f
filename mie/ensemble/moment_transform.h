// Legendre moments of the phase function from products of partial waves.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "mie/ensemble/band_covariance.h"
#include "mie/ensemble/executor.h"

namespace miebrdf::mie {

/// sum over n, m of (2n+1)(2m+1) f_l^2 [C+ + (-1)^(n+m+l) C-](n, |n - m|), l = 0 ... width, with
/// the 3j symbol f_l = (n m l; 1 -1 0). Divided by its first entry this is chi_l.
///
/// All weights are squares, so nothing cancels. f_l comes upward in l from its closed form at
/// l = |n - m|, stable because f_l grows or oscillates that way:
///     a(l+1) f_{l+1} = 2 (2l+1) f_l - a(l) f_{l-1},  a(l)^2 = (l^2 - d^2)(K^2 - l^2),  K = n + m
///     + 1.
/// Cost: terms * width^2 / 2 steps.
class MomentTransform {
  public:
    /// Tables for covariances of so many terms and this width.
    MomentTransform(int terms, int width, const Executor& run = run_in_order);

    std::vector<double> operator()(const BandCovariance& covariance,
                                   const Executor& run = run_in_order) const;

  private:
    int terms_, width_;
    // 1 / sqrt(K^2 - l^2), 0 for l >= K (there the 3j symbol vanishes), for each parity of K:
    // column l, row j for K = 2 j + parity.
    Eigen::ArrayXXd inverse_roots_[2];
};

/// The same with tables that are used once.
inline std::vector<double> moments_from_covariance(const BandCovariance& covariance,
                                                   const Executor& run = run_in_order) {
    return MomentTransform(covariance.terms(), covariance.width(), run)(covariance, run);
}

}  // namespace miebrdf::mie
