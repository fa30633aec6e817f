// Values at scattered points, interpolated by kriging (a Gaussian process with a trend): what lies
// between follows the neighbours, what lies beyond returns to the trend.
#pragma once

#include <Eigen/Core>

#include <vector>

namespace miebrdf::math {

/// Points in which a function is known that does not change when the last two coordinates are
/// exchanged.
struct ScatteredPoints {
    Eigen::MatrixXd at;      ///< n x dimensions, two or more
    Eigen::MatrixXd trend;   ///< n x terms: the terms of the trend at each point
    Eigen::MatrixXd values;  ///< n x columns
};

/// Matern's covariance with nu = 5/2 (twice differentiable), of variance 1.
struct KrigingKernel {
    /// Over which values stay alike: one for each dimension, but one for the last two, which are
    /// exchanged.
    Eigen::ArrayXd lengths;
    double nugget = 1e-3;  ///< variance of what is noise, relative to the kernel's
};

class Kriging {
  public:
    /// Costs 3 n^3. @throws std::invalid_argument  for lists that do not fit, and fewer points than
    /// terms
    Kriging(const ScatteredPoints& points, KrigingKernel kernel);

    /// The value of each column at one point.
    Eigen::RowVectorXd evaluate(const Eigen::RowVectorXd& at,
                                const Eigen::RowVectorXd& trend) const;

    /// n x columns: values less what the interpolation has at their own points.
    const Eigen::MatrixXd& residuals() const { return residuals_; }
    /// n x columns: values less what all others say of them (Dubrule 1983, Math. Geology 15, 687).
    const Eigen::MatrixXd& leave_one_out() const { return leave_one_out_; }

  private:
    Eigen::ArrayXXd scaled_, scaled_mirrored_;  ///< dimensions x n, divided by the lengths
    KrigingKernel kernel_;
    Eigen::MatrixXd weights_, coefficients_, residuals_, leave_one_out_;
};

/// Lengths and nugget of least leave-one-out error of some of the points, by trying factors of
/// three, then of the root of three, one number at a time.
/// @param most_points  that are taken, evenly spread over the list
KrigingKernel fitted_kernel(const ScatteredPoints& points, int most_points = 350);

}  // namespace miebrdf::math
