#include "pipeline/solve/low_rank.h"

#include <algorithm>
#include <cmath>

namespace miebrdf {
namespace {

/// Steps of the basis times the largest coefficient, over the scales of rows and columns and the
/// accuracy.
constexpr double kBasisStep = 0.1;

}  // namespace

LowRank reduce_rank(const Eigen::MatrixXd& table, Eigen::VectorXd scale,
                    Eigen::VectorXd column_scale, double tolerance, double accuracy) {
    const auto inverse = [](double value) { return value > 0.0 ? 1.0 / value : 0.0; };
    Eigen::MatrixXd rest = scale.unaryExpr(inverse).asDiagonal() * table *
                           column_scale.unaryExpr(inverse).asDiagonal();
    const Eigen::MatrixXd scaled = rest;
    const Eigen::Index most = std::min(rest.rows(), rest.cols());
    Eigen::MatrixXd basis(rest.rows(), most);
    Eigen::Index rank = 0;
    for (; rank < most; ++rank) {
        Eigen::Index worst = 0;
        const double largest = rest.cwiseAbs().colwise().maxCoeff().maxCoeff(&worst);
        if (!(largest > tolerance)) break;
        Eigen::VectorXd direction = rest.col(worst);
        // Once more, against the rounding of the first time.
        direction -= basis.leftCols(rank) * (basis.leftCols(rank).transpose() * direction);
        direction.normalize();
        basis.col(rank) = direction;
        rest -= direction * (direction.transpose() * rest);
    }
    LowRank reduced{std::move(scale), std::move(column_scale), basis.leftCols(rank), {}, {}};
    reduced.coefficients = reduced.basis.transpose() * scaled;
    reduced.step = reduced.coefficients.cwiseAbs().rowwise().maxCoeff().cwiseInverse() *
                   (kBasisStep * accuracy);
    for (Eigen::Index k = 0; k < rank; ++k) {
        const double step = reduced.step[k];
        reduced.basis.col(k) =
            reduced.basis.col(k).unaryExpr([&](double v) { return step * std::round(v / step); });
    }
    return reduced;
}

}  // namespace miebrdf
