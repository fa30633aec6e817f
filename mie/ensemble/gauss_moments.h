// All moments of ensembles whose bands of products would be as wide as they are long.
#pragma once

#include <vector>

#include "mie/ensemble/size_sums.h"
#include "rte/math/quadrature.h"

namespace miebrdf::mie {

/// Moments from the intensity at Gauss nodes in cos(angle). P has the degree 2 * terms, so that
/// nothing but rounding is lost; in double precision. For each size as many multiply-adds as
/// 8 * terms * nodes, where a band with all moments has twice as few, but takes terms^3 after each
/// pass.
class GaussMoments {
  public:
    /// @param terms           partial waves of the largest sphere
    /// @param highest_moment  0 to 2 * terms
    GaussMoments(int terms, int highest_moment, const Executor& run);

    const AngularFunctions& angles() const { return angles_; }
    /// chi_0 ... chi_highest from what the angles have summed, times an unknown factor.
    std::vector<double> of(const Eigen::VectorXd& intensity) const;

  private:
    int highest_;
    math::Quadrature rule_;
    AngularFunctions angles_;
};

}  // namespace miebrdf::mie
