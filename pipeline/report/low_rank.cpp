#include "pipeline/report/low_rank.h"

#include <algorithm>

namespace miebrdf::report {

Eigen::VectorXd LowRank::sum_of_rows(const Eigen::VectorXi& rows,
                                     const Eigen::VectorXd& weights) const {
    Eigen::VectorXd in_basis = Eigen::VectorXd::Zero(basis.cols());
    for (Eigen::Index k = 0; k < rows.size(); ++k)
        in_basis += weights[k] * scale[rows[k]] * basis.row(rows[k]).transpose();
    return coefficients.transpose() * in_basis;
}

LowRank reduce_rank(const Eigen::MatrixXd& table, Eigen::VectorXd scale, double tolerance) {
    Eigen::MatrixXd rest = table;
    for (Eigen::Index row = 0; row < rest.rows(); ++row)
        rest.row(row) *= scale[row] > 0.0 ? 1.0 / scale[row] : 0.0;
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
    LowRank reduced{std::move(scale), basis.leftCols(rank), {}};
    reduced.coefficients = reduced.basis.transpose() * scaled;
    return reduced;
}

}  // namespace miebrdf::report
