// Eigenvalues and eigenvectors of symmetric matrices of up to a few hundred rows.
#pragma once

#include <Eigen/Eigenvalues>
#include <memory>

namespace miebrdf::math {

/// Eigen's solver for one matrix after the other. Up to `most_in_place` rows it works in memory of
/// its own: the one for matrices of any size allocates at every call.
class SymmetricEigen {
  public:
    static constexpr int most_in_place = 128;  ///< what Eigen lets a matrix without heap hold

    SymmetricEigen();

    /// @param matrix  of which the lower triangle is read
    /// @return false if the iteration does not converge
    bool compute(const Eigen::MatrixXd& matrix);

    /// Ascending; valid until the next call.
    Eigen::Map<const Eigen::VectorXd> values() const;
    /// One column each, orthonormal; valid until the next call.
    Eigen::Map<const Eigen::MatrixXd> vectors() const;

  private:
    using Bounded = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor,
                                  most_in_place, most_in_place>;

    std::unique_ptr<Eigen::SelfAdjointEigenSolver<Bounded>> bounded_;
    Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> unbounded_;
    Eigen::Index size_ = 0;
};

}  // namespace miebrdf::math
