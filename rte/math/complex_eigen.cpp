#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include "rte/math/interruption.h"
#include "rte/math/matrices.h"

namespace miebrdf::math {

bool ComplexEigen::compute(const Eigen::MatrixXd& A) {
    interruption_point();
    const Eigen::EigenSolver<Eigen::MatrixXd> solver(A);
    if (solver.info() != Eigen::Success) return false;
    vectors = solver.eigenvectors();
    values = solver.eigenvalues();
    inverse = vectors.partialPivLu().inverse();
    return inverse.allFinite();
}

Eigen::MatrixXd ComplexEigen::function(const Eigen::ArrayXcd& of_values) const {
    return (vectors * of_values.matrix().asDiagonal() * inverse).real();
}

}  // namespace miebrdf::math
