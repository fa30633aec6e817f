// Inverses of small symmetric positive definite matrices.
#pragma once

#include <Eigen/Core>

namespace miebrdf::math {

/// The inverse of a lower triangular matrix, in place; what is above the diagonal becomes zero.
/// By halves, so that nearly all of it is products of matrices (n = 32: half the time of a
/// triangular solve).
void invert_lower(Eigen::Ref<Eigen::MatrixXd> lower);

/// A^-1 = L^-T L^-1, exactly symmetric, by Cholesky's factors A = L L^T.
///
/// @param matrix   A, of which the lower triangle is read; overwritten by L^-1
/// @param inverse  resized to n x n
/// @return false if A is not positive definite; `inverse` is undefined then
bool invert_positive_definite(Eigen::MatrixXd& matrix, Eigen::MatrixXd& inverse);

}  // namespace miebrdf::math
