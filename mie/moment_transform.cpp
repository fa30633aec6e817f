#include "mie/moment_transform.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

namespace miebrdf::mie {
namespace {

// Orders n handled together; enough independent recurrences to hide the latency of each.
constexpr int group = 32;
using Group = Eigen::Array<double, group, 1>;

// 1 / sqrt(K^2 - l^2), 0 for l >= K (there the 3j symbol vanishes), for one parity of K:
// column l, row j for K = 2 j + parity.
Eigen::ArrayXXd inverse_roots(int largest_j, int highest_l, int parity) {
    Eigen::ArrayXXd table(largest_j + 1, highest_l + 1);
    for (int l = 0; l <= highest_l; ++l) {
        for (int j = 0; j <= largest_j; ++j) {
            const double K = 2.0 * j + parity;
            table(j, l) = K > l ? 1 / std::sqrt((K - l) * (K + l)) : 0.0;
        }
    }
    return table;
}

// Everything for one d = |n - m|; adds to moments.
class OneDiagonal {
  public:
    OneDiagonal(const BandCovariance& covariance, int d, const Eigen::ArrayXXd& inverse_root)
        : covariance_(covariance), inverse_root_(inverse_root), d_(d), L_(covariance.width()) {
        for (int l = 0; l <= L_ + 1; ++l) {
            e_.push_back(l > d ? std::sqrt(static_cast<double>(l - d) * (l + d)) : 0.0);
        }
    }

    void add_orders_from(int first, std::vector<double>& moments) const {
        Group gain_plus = Group::Zero(), gain_minus = Group::Zero(), f = Group::Zero(), K;
        const int last = std::min(first + group - 1, covariance_.terms() - d_);
        for (int i = 0; i < group; ++i) {
            const double n = first + i;
            const double m = n + d_;
            K[i] = n + m + 1;
            if (first + i > last) continue;
            const double weight = (d_ == 0 ? 1 : 2) * (2 * n + 1) * (2 * m + 1);
            gain_plus[i] = weight * covariance_.plus()(first + i, d_);
            gain_minus[i] = weight * covariance_.minus()(first + i, d_);
            f[i] = std::sqrt(first_square(n));
        }
        // K = 2 j + parity with parity = 1 for even d, 0 for odd.
        const int j = first + (d_ + 1) / 2;
        const Group K_squared = K.square();
        Group f_before = Group::Zero();
        Group root_here = inverse_root_.col(d_).segment<group>(j);
        for (int l = d_; l <= L_; ++l) {
            const Group square = f.square();
            const double same = (square * gain_plus).sum();
            const double mirrored = (square * gain_minus).sum();
            moments[l] += (l - d_) % 2 == 0 ? same + mirrored : same - mirrored;
            if (l == L_) break;
            const Group root_next = inverse_root_.col(l + 1).segment<group>(j);
            const double alpha = 2 * (2 * l + 1) / e_[l + 1];
            const double beta = e_[l] / e_[l + 1];
            const Group next =
                root_next *
                (alpha * f -
                 (beta * f_before) * ((K_squared - static_cast<double>(l) * l) * root_here));
            f_before = f;
            f = next;
            root_here = root_next;
        }
    }

  private:
    // f_d^2 for m = n + d: from 1/(2n + 1) at d = 0 by its ratio from d to d + 1.
    double first_square(double n) const {
        double square = 1 / (2 * n + 1);
        for (int d = 0; d < d_; ++d) {
            const double m = n + d;
            square *= 2.0 * (2 * d + 1) / (d + 1) * (m + 2) * m / ((2 * m + 3) * (2 * m + 2));
        }
        return square;
    }

    const BandCovariance& covariance_;
    const Eigen::ArrayXXd& inverse_root_;
    int d_, L_;
    std::vector<double> e_;  // sqrt(l^2 - d^2)
};

}  // namespace

std::vector<double> moments_from_covariance(const BandCovariance& covariance) {
    const int L = covariance.width();
    const int terms = covariance.terms();
    const int largest_j = terms + L + group;
    const Eigen::ArrayXXd odd_K = inverse_roots(largest_j, L, 1);
    const Eigen::ArrayXXd even_K = inverse_roots(largest_j, L, 0);
    std::vector<double> moments(L + 1, 0.0);
    for (int d = 0; d <= std::min(L, terms - 1); ++d) {
        const OneDiagonal diagonal(covariance, d, d % 2 == 0 ? odd_K : even_K);
        for (int first = 1; first + d <= terms; first += group) {
            diagonal.add_orders_from(first, moments);
        }
    }
    return moments;
}

}  // namespace miebrdf::mie
