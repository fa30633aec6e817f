// Size-averaged products of neighbouring partial waves: all that Legendre moments need of the
// sizes.
#pragma once

#include <Eigen/Core>

#include "mie/sphere/sphere_block.h"

namespace miebrdf::mie {

/// C+(n, d) = sum over spheres of Re U_n U*_{n+d}, C-(n, d) the same of V, with U = a + b, V = a -
/// b and the weights of the block; n = 1 ... terms (row 0 is zero), d = 0 ... width. Moments chi_0
/// ... chi_L need the band of width L and no more (moment_transform.h).
class BandCovariance {
  public:
    using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

    BandCovariance() = default;
    BandCovariance(int terms, int width);

    /// 4 * terms * (width + 1) * size multiply-adds, as products of small dense matrices. A block
    /// in single precision sums in it: twice as fast, 5e-9 of the moments (measured).
    template <typename Scalar>
    void add(const SphereBlockOf<Scalar>& block);
    void add(const BandCovariance& other);
    void scale(double factor);

    const Matrix& plus() const { return plus_; }
    const Matrix& minus() const { return minus_; }
    int terms() const { return static_cast<int>(plus_.rows()) - 1; }
    int width() const { return static_cast<int>(plus_.cols()) - 1; }

  private:
    Matrix plus_, minus_;
};

}  // namespace miebrdf::mie
