// Tables as a few basis columns: the spectra of a smooth table are sums of some of them.
#pragma once

#include <Eigen/Core>

namespace miebrdf::report {

/// table(row, column) is about scale(row) * (basis * coefficients)(row, column).
struct LowRank {
    Eigen::VectorXd scale;         ///< largest |value| of each row
    Eigen::MatrixXd basis;         ///< rows x rank, orthonormal columns
    Eigen::MatrixXd coefficients;  ///< rank x columns

    double at(Eigen::Index row, Eigen::Index column) const {
        return scale[row] * basis.row(row).dot(coefficients.col(column));
    }
    /// Weighted sum of some rows, all columns: what interpolation needs.
    Eigen::VectorXd sum_of_rows(const Eigen::VectorXi& rows, const Eigen::VectorXd& weights) const;
};

/// Chooses columns of the table one after the other, always the one that is described worst by
/// those chosen before (Gram-Schmidt with pivoting), until no value is off by more than the
/// tolerance.
/// @param scale      of each row; values are compared after division by it. 0: the row is 0
/// @param tolerance  absolute, of values over their row's scale, > 0
LowRank reduce_rank(const Eigen::MatrixXd& table, Eigen::VectorXd scale, double tolerance);

}  // namespace miebrdf::report
