#include "rte/math/matrices.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include "rte/math/interruption.h"

namespace miebrdf::math {

void invert_lower(Eigen::Ref<Eigen::MatrixXd> lower) {
    constexpr Eigen::Index small = 16;
    const Eigen::Index n = lower.rows();
    if (n <= small) {
        Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, small, small> inverse;
        inverse.setIdentity(n, n);
        lower.triangularView<Eigen::Lower>().solveInPlace(inverse);
        lower = inverse;
        return;
    }
    // [A 0; B C]^-1 = [A^-1 0; -C^-1 B A^-1 C^-1]
    const Eigen::Index half = n / 2;
    auto below = lower.bottomLeftCorner(n - half, half);
    invert_lower(lower.topLeftCorner(half, half));
    invert_lower(lower.bottomRightCorner(n - half, n - half));
    // The upper corner is free: it holds the product in between, transposed.
    auto between = lower.topRightCorner(half, n - half);
    between.noalias() = lower.topLeftCorner(half, half).transpose() * below.transpose();
    below.noalias() = -lower.bottomRightCorner(n - half, n - half) * between.transpose();
    between.setZero();
}

bool invert_positive_definite(Eigen::MatrixXd& matrix, Eigen::MatrixXd& inverse) {
    interruption_point();
    Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> factor(matrix);
    if (factor.info() != Eigen::Success) return false;
    if (!matrix.diagonal().allFinite()) return false;  // NaN passes Eigen's test of the pivots
    invert_lower(matrix);
    inverse.noalias() = matrix.transpose() * matrix;
    inverse.triangularView<Eigen::StrictlyUpper>() = inverse.transpose();
    return true;
}

bool SymmetricEigen::compute(const Eigen::MatrixXd& matrix) {
    interruption_point();
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(matrix);
    if (solver.info() != Eigen::Success) return false;
    values_ = solver.eigenvalues();
    vectors_ = solver.eigenvectors();
    return true;
}

}  // namespace miebrdf::math
