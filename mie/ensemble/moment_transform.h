// Legendre moments of the phase function from size-averaged products of neighbouring partial waves:
// all that moments need of the sizes.
#pragma once

#include <Eigen/Core>
#include <vector>

#include <miebrdf/ensemble.h>
#include "mie/sphere/sphere_block.h"

namespace miebrdf::mie {

/// C+(n, d) = sum over spheres of Re U_n U*_{n+d}, C-(n, d) the same of V, with U = a + b, V = a -
/// b and the weights of the block; n = 1 ... terms (row 0 is zero), d = 0 ... width. Moments chi_0
/// ... chi_L need the band of width L and no more.
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

/// sum over n, m of (2n+1)(2m+1) f_l^2 [C+ + (-1)^(n+m+l) C-](n, |n - m|), l = 0 ... width, with
/// the 3j symbol f_l = (n m l; 1 -1 0). Divided by its first entry this is chi_l.
///
/// All weights are squares, so nothing cancels. f_l comes upward in l from its closed form at
/// l = |n - m|, stable because f_l grows or oscillates that way:
///     a(l+1) f_{l+1} = 2 (2l+1) f_l - a(l) f_{l-1},  a(l)^2 = (l^2 - d^2)(K^2 - l^2),  K = n + m
///     + 1.
/// Where n is well above l, (2n+1) f_l^2 is an analytic function of 1/n, whose nearest singularity
/// is n = -(l + d + 1)/2: the orders above the width are interpolated to rounding from 16 values of
/// n. Cost: (width + 16) * width^2 / 2 steps, and 32 * terms * width multiply-adds.
class MomentTransform {
  public:
    /// Covariances collected on the orders that are transformed: row = order, column = d;
    /// (2m+1) times their sums over n.
    struct Collected {
        Eigen::MatrixXd plus, minus;
    };

    /// For covariances of so many terms and this width.
    MomentTransform(int terms, int width);

    std::vector<double> operator()(const BandCovariance& covariance,
                                   const Executor& run = run_in_order) const;
    std::vector<double> operator()(const Collected& collected,
                                   const Executor& run = run_in_order) const;

    int width() const { return width_; }
    /// Orders 1 ... direct() are transformed one by one.
    int direct() const { return direct_; }
    /// All orders, and those among them, the last ones, that interpolate.
    int order_count() const { return static_cast<int>(orders_.size()); }
    int interpolating() const { return order_count() - direct_; }
    /// Shares of an n above direct() on the orders that interpolate.
    Eigen::VectorXd shares(double n) const;

  private:
    int terms_, width_, direct_;
    std::vector<double> orders_;  // n of each row; above direct_ not integers
    Eigen::VectorXd places_, barycentric_;
    // 1 / sqrt(K^2 - l^2) for each parity of K: column l, row j for K = 2 (j + 1) + parity.
    Eigen::ArrayXXd inverse_roots_[2];
};

}  // namespace miebrdf::mie
