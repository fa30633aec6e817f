// Tables as a few basis columns: the spectra of a smooth table are sums of some of them.
#pragma once

#include <Eigen/Core>

namespace miebrdf {

/// table(row, column) is about
/// scale(row) * column_scale(column) * (basis * coefficients)(row, column).
struct LowRank {
    Eigen::VectorXd scale;         ///< of each row
    Eigen::VectorXd column_scale;  ///< of each column; 1 unless set
    Eigen::MatrixXd basis;         ///< rows x rank, rounded to multiples of `step`
    Eigen::VectorXd step;          ///< of each column of the basis
    Eigen::MatrixXd coefficients;  ///< rank x columns
};

/// Chooses columns of the table one after the other, always the one that is described worst by
/// those chosen before (Gram-Schmidt with pivoting), until no value is off by more than the
/// tolerance. The basis is rounded to steps that move no value by more than a twentieth of the
/// accuracy each.
/// @param scale      of each row; values are compared after division by it. 0: the row is 0
/// @param column_scale  likewise of each column
/// @param tolerance  absolute, of values over their row's scale, > 0
/// @param accuracy   likewise, of the basis and of all together
LowRank reduce_rank(const Eigen::MatrixXd& table, Eigen::VectorXd scale,
                    Eigen::VectorXd column_scale, double tolerance, double accuracy);

}  // namespace miebrdf
