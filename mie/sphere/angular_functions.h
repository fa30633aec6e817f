// Phase function of an ensemble at listed angles, from the partial waves of its spheres.
#pragma once

#include <Eigen/Core>
#include <span>

#include "mie/ensemble/executor.h"
#include "mie/sphere/sphere_block.h"

namespace miebrdf::mie {

/// S1 +- S2 = sum_n (2n+1)/(n(n+1)) (a_n +- b_n) (pi_n +- tau_n): the tables of the angular part,
/// shared by all sizes. Row = angle, column = n (column 0 unused). Scalar: float or double.
template <typename Scalar>
class AngularFunctionsOf {
  public:
    AngularFunctionsOf() = default;
    /// @throws std::invalid_argument  for an angle outside 0 to 180 degrees
    AngularFunctionsOf(std::span<const double> angles_deg, int terms,
                       const Executor& run = run_in_order);

    int angle_count() const { return static_cast<int>(plus_.rows()); }

    /// Adds sum over the block's spheres of |S1 + S2|^2 + |S1 - S2|^2 at each angle; with the
    /// weights of SphereSums this is P times 2 * scattered.
    void add_intensity(const SphereBlockOf<Scalar>& block, Eigen::VectorXd& intensity) const;

  private:
    void fill(Eigen::Index first, const Eigen::ArrayXd& mu);

    using Matrix = Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic>;

    void add_squares(const Matrix& functions, const typename SphereBlockOf<Scalar>::Matrix& waves,
                     int terms, int columns, Eigen::VectorXd& intensity) const;

    Matrix plus_, minus_;
};

using AngularFunctions = AngularFunctionsOf<double>;

}  // namespace miebrdf::mie
