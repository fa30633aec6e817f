// Interpolation between Chebyshev's points.
#pragma once

#include <Eigen/Core>

namespace miebrdf::math {

/// Chebyshev's points of the first kind on (-1, 1), to interpolate between by the barycentric
/// formula.
class ChebyshevPoints {
  public:
    explicit ChebyshevPoints(int count = 1);
    int count() const { return int(points_.size()); }
    double operator[](int node) const { return points_[node]; }
    /// Lagrange's weights at t.
    Eigen::VectorXd weights(double t) const;

  private:
    Eigen::VectorXd points_;
    Eigen::VectorXd factors_;
};

}  // namespace miebrdf::math
