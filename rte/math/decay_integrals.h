// Integrals of one decaying exponential against another over a layer, without cancellation.
#pragma once

#include <Eigen/Core>

namespace miebrdf::math {

struct DecayIntegrals {
    double near;  ///< x int_0^1 exp(-x u) sinh(y (1 - u)) / sinh(y) du
    double far;   ///< x int_0^1 exp(-x u) sinh(y u) / sinh(y) du
};

/// Both for x = tau / mu >= 0 and y = k tau >= 0; y = 0 is the limit sinh(y u) / sinh(y) = u.
/// Relative error a few units in the last place everywhere, x = y included: three forms of the same
/// integrals, each used where nothing cancels.
DecayIntegrals decay_integrals(double x, double y);

/// The same for all pairs: near and far are resized to x.size() x y.size(). Where both arguments
/// are below 1 the exponentials are tabulated once for each x and each y.
void decay_integrals(const Eigen::ArrayXd& x, const Eigen::ArrayXd& y, Eigen::MatrixXd& near,
                     Eigen::MatrixXd& far);

}  // namespace miebrdf::math
