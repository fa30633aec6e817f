// Matrices of up to a few hundred rows: scratch memory, inverses, eigenvectors.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <memory>
#include <new>

namespace miebrdf::math {

/// A column-major matrix or vector that keeps its memory when it becomes smaller, for loops in
/// which sizes change from step to step (Eigen's own frees and allocates at every change). Contents
/// are undefined after `resize`. Everything that reads Eigen's expressions can read it.
template <typename Plain>
class Scratch : public Eigen::Map<Plain> {
    using View = Eigen::Map<Plain>;

  public:
    Scratch()
        : View(nullptr, Plain::RowsAtCompileTime == Eigen::Dynamic ? 0 : 1,
               Plain::ColsAtCompileTime == Eigen::Dynamic ? 0 : 1) {}
    Scratch(const Scratch& other) : Scratch() { *this = other; }
    template <typename Derived>
    Scratch(const Eigen::MatrixBase<Derived>& values) : Scratch() {
        *this = values;
    }

    Scratch& operator=(const Scratch& other) {
        return *this = static_cast<const Eigen::MatrixBase<View>&>(other);
    }
    template <typename Derived>
    Scratch& operator=(const Eigen::MatrixBase<Derived>& values) {
        resize(values.rows(), values.cols());
        View::operator=(values.derived());
        return *this;
    }

    void resize(Eigen::Index rows, Eigen::Index cols = 1) {
        // Never a null pointer: Eigen forms references into empty matrices, too.
        const Eigen::Index size = std::max<Eigen::Index>(1, rows * cols);
        if (size > memory_.size()) memory_.resize(size);
        look_at(rows, cols);
    }

    /// One more column, of as many rows, with the contents kept.
    template <typename Derived>
    void append_column(const Eigen::MatrixBase<Derived>& column) {
        const Eigen::Index rows = this->rows(), cols = this->cols() + 1;
        if (rows * cols > memory_.size()) memory_.conservativeResize(rows * cols);
        look_at(rows, cols);
        this->col(cols - 1) = column;
    }
    /// One more element of a vector.
    void append(double element) {
        const Eigen::Index size = this->size() + 1;
        if (size > memory_.size()) memory_.conservativeResize(size);
        look_at(size, 1);
        (*this)[size - 1] = element;
    }

  private:
    void look_at(Eigen::Index rows, Eigen::Index cols) {
        ::new (static_cast<View*>(this)) View(memory_.data(), rows, cols);
    }

    Eigen::VectorXd memory_;
};

using ScratchMatrix = Scratch<Eigen::MatrixXd>;
using ScratchVector = Scratch<Eigen::VectorXd>;

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

/// Eigenvalues and eigenvectors of one symmetric matrix after the other. Up to `kMostInPlace` rows
/// nothing is allocated: Eigen's solver for matrices of any size allocates at every call.
class SymmetricEigen {
  public:
    static constexpr int kMostInPlace = 128;  ///< what Eigen lets a matrix without heap hold

    SymmetricEigen();
    ~SymmetricEigen();
    SymmetricEigen(SymmetricEigen&&) noexcept;
    SymmetricEigen& operator=(SymmetricEigen&&) noexcept;

    /// @param matrix  of which the lower triangle is read
    /// @return false if the iteration does not converge
    bool compute(const Eigen::MatrixXd& matrix);

    /// Ascending; valid until the next call.
    Eigen::Map<const Eigen::VectorXd> values() const;
    /// One column each, orthonormal; valid until the next call.
    Eigen::Map<const Eigen::MatrixXd> vectors() const;

  private:
    struct Solvers;
    std::unique_ptr<Solvers> solvers_;
    Eigen::Index size_ = 0;
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
