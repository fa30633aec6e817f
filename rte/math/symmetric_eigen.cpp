#include "rte/math/symmetric_eigen.h"

namespace miebrdf::math {

SymmetricEigen::SymmetricEigen()
    : bounded_(std::make_unique<Eigen::SelfAdjointEigenSolver<Bounded>>()) {}

bool SymmetricEigen::compute(const Eigen::MatrixXd& matrix) {
    size_ = matrix.rows();
    if (size_ > most_in_place) return unbounded_.compute(matrix).info() == Eigen::Success;
    return bounded_->compute(matrix).info() == Eigen::Success;
}

Eigen::Map<const Eigen::VectorXd> SymmetricEigen::values() const {
    const double* values =
        size_ > most_in_place ? unbounded_.eigenvalues().data() : bounded_->eigenvalues().data();
    return {values, size_};
}

Eigen::Map<const Eigen::MatrixXd> SymmetricEigen::vectors() const {
    const double* vectors =
        size_ > most_in_place ? unbounded_.eigenvectors().data() : bounded_->eigenvectors().data();
    return {vectors, size_, size_};
}

}  // namespace miebrdf::math
