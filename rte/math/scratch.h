// Matrices for intermediate results whose memory only grows.
#pragma once

#include <Eigen/Core>
#include <algorithm>
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
        ::new (static_cast<View*>(this)) View(memory_.data(), rows, cols);
    }

  private:
    Eigen::VectorXd memory_;
};

using ScratchMatrix = Scratch<Eigen::MatrixXd>;
using ScratchVector = Scratch<Eigen::VectorXd>;

}  // namespace miebrdf::math
