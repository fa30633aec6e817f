#include "rte/math/chebyshev_points.h"

#include <cmath>
#include <numbers>

namespace miebrdf::math {

ChebyshevPoints::ChebyshevPoints(int count) : points_(count), factors_(count) {
    for (int j = 0; j < count; ++j) {
        const double angle = std::numbers::pi * (j + 0.5) / count;
        points_[j] = std::cos(angle);
        factors_[j] = (j % 2 ? -1.0 : 1.0) * std::sin(angle);
    }
}

Eigen::VectorXd ChebyshevPoints::weights(double t) const {
    Eigen::VectorXd weights(points_.size());
    for (Eigen::Index j = 0; j < points_.size(); ++j) {
        const double distance = t - points_[j];
        if (distance == 0.0) return Eigen::VectorXd::Unit(points_.size(), j);
        weights[j] = factors_[j] / distance;
    }
    return weights / weights.sum();
}

}  // namespace miebrdf::math
