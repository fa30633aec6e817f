#include "rte/math/matrices.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

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
    Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> factor(matrix);
    if (factor.info() != Eigen::Success) return false;
    if (!matrix.diagonal().allFinite()) return false;  // NaN passes Eigen's test of the pivots
    invert_lower(matrix);
    inverse.noalias() = matrix.transpose() * matrix;
    inverse.triangularView<Eigen::StrictlyUpper>() = inverse.transpose();
    return true;
}

struct SymmetricEigen::Solvers {
    using Bounded = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor,
                                  kMostInPlace, kMostInPlace>;
    Eigen::SelfAdjointEigenSolver<Bounded> in_place;
    Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> of_any_size;
};

SymmetricEigen::SymmetricEigen() : solvers_(std::make_unique<Solvers>()) {}
SymmetricEigen::~SymmetricEigen() = default;
SymmetricEigen::SymmetricEigen(SymmetricEigen&&) noexcept = default;
SymmetricEigen& SymmetricEigen::operator=(SymmetricEigen&&) noexcept = default;

bool SymmetricEigen::compute(const Eigen::MatrixXd& matrix) {
    size_ = matrix.rows();
    if (size_ > kMostInPlace) {
        return solvers_->of_any_size.compute(matrix).info() == Eigen::Success;
    }
    return solvers_->in_place.compute(matrix).info() == Eigen::Success;
}

Eigen::Map<const Eigen::VectorXd> SymmetricEigen::values() const {
    const double* values = size_ > kMostInPlace ? solvers_->of_any_size.eigenvalues().data()
                                                : solvers_->in_place.eigenvalues().data();
    return {values, size_};
}

Eigen::Map<const Eigen::MatrixXd> SymmetricEigen::vectors() const {
    const double* vectors = size_ > kMostInPlace ? solvers_->of_any_size.eigenvectors().data()
                                                 : solvers_->in_place.eigenvectors().data();
    return {vectors, size_, size_};
}

}  // namespace miebrdf::math
