// Matrices of up to a few hundred rows: inverses, eigenvectors.
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

/// Eigenvalues and eigenvectors of a symmetric matrix.
class SymmetricEigen {
  public:
    /// @param matrix  of which the lower triangle is read
    /// @return false if the iteration does not converge
    bool compute(const Eigen::MatrixXd& matrix);

    const Eigen::VectorXd& values() const { return values_; }    ///< ascending
    const Eigen::MatrixXd& vectors() const { return vectors_; }  ///< one column each, orthonormal

  private:
    Eigen::VectorXd values_;
    Eigen::MatrixXd vectors_;
};

/// Eigenvalues and eigenvectors of a matrix that need not be symmetric, A = W diag(values) W^-1.
struct ComplexEigen {
    Eigen::VectorXcd values;
    Eigen::MatrixXcd vectors, inverse;  ///< W and W^-1

    /// @return false if the iteration does not converge or W has no inverse
    bool compute(const Eigen::MatrixXd& A);

    /// W diag(f) W^-1 for f of each eigenvalue, those of pairs being conjugate.
    Eigen::MatrixXd function(const Eigen::ArrayXcd& of_values) const;
};

}  // namespace miebrdf::math
