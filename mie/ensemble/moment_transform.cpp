#include "mie/ensemble/moment_transform.h"

#include <algorithm>
#include <cmath>

namespace miebrdf::mie {
namespace {

// Rows of a tile: products of tile x (tile + width) blocks waste half a tile squared each, but
// narrower ones run slower.
constexpr int kTileRows = 32;

template <typename Waves>
void add_band(const Waves& waves, int terms, int columns, BandCovariance::Matrix& band) {
    const int width = static_cast<int>(band.cols()) - 1;
    Waves tile;
    for (int n = 1; n <= terms; n += kTileRows) {
        const int rows = std::min(kTileRows, terms - n + 1);
        const int reach = std::min(rows + width, terms - n + 1);
        tile.noalias() =
            waves.block(n, 0, rows, columns) * waves.block(n, 0, reach, columns).transpose();
        for (int i = 0; i < rows; ++i) {
            const int count = std::min(width + 1, reach - i);
            band.row(n + i).head(count) += tile.row(i).segment(i, count).template cast<double>();
        }
    }
}

// Orders n handled together; enough independent recurrences to hide the latency of each.
constexpr int kGroup = 32;
constexpr int kDiagonalsAtOnce = 64;
constexpr int kDiagonalsPerJob = 8;
using Group = Eigen::Array<double, kGroup, 1>;
using Lane = Eigen::Array<double, 8, 1>;

Lane folded(const Group& g) {
    return (g.segment<8>(0) + g.segment<8>(8)) + (g.segment<8>(16) + g.segment<8>(24));
}

Eigen::ArrayXXd inverse_roots(int largest_j, int highest_l, int parity) {
    const Eigen::ArrayXd K = 2 * Eigen::ArrayXd::LinSpaced(largest_j + 1, 0, largest_j) + parity;
    Eigen::ArrayXXd table(largest_j + 1, highest_l + 1);
    for (int l = 0; l <= highest_l; ++l) {
        const double last = l;
        table.col(l) = (K > last).select(1 / ((K - last) * (K + last)).abs().sqrt(), 0.0);
    }
    return table;
}

// f_d^2 for m = n + d, all n at once: from 1/(2n + 1) at d = 0 by its ratio from d to d + 1.
class FirstSquares {
  public:
    explicit FirstSquares(int count)
        : n_(Eigen::ArrayXd::LinSpaced(count, 0, count - 1)), square_(1 / (2 * n_ + 1)) {}

    const Eigen::ArrayXd& values() const { return square_; }

    void next() {
        const Eigen::ArrayXd m = n_ + d_;
        square_ *= (2.0 * (2 * d_ + 1) / (d_ + 1)) * (m + 2) * m / ((2 * m + 3) * (2 * m + 2));
        ++d_;
    }

  private:
    Eigen::ArrayXd n_, square_;
    int d_ = 0;
};

// Everything for one d = |n - m|.
class OneDiagonal {
  public:
    OneDiagonal(const BandCovariance& covariance, int d, const Eigen::ArrayXd& first_squares,
                const Eigen::ArrayXXd& inverse_root)
        : covariance_(covariance),
          first_squares_(first_squares),
          inverse_root_(inverse_root),
          d_(d),
          L_(covariance.width()) {
        for (int l = 0; l <= L_ + 1; ++l) {
            e_.push_back(l > d ? std::sqrt(static_cast<double>(l - d) * (l + d)) : 0.0);
        }
    }

    // Adds the orders first ... first + group - 1 to moments, eight partial sums per l.
    void add_orders_from(int first, std::vector<Lane>& moments) const {
        Group gain_plus = Group::Zero(), gain_minus = Group::Zero(), f = Group::Zero(), K;
        const int last = std::min(first + kGroup - 1, covariance_.terms() - d_);
        for (int i = 0; i < kGroup; ++i) {
            const double n = first + i;
            const double m = n + d_;
            K[i] = n + m + 1;
            if (first + i > last) continue;
            const double weight = (d_ == 0 ? 1 : 2) * (2 * n + 1) * (2 * m + 1);
            gain_plus[i] = weight * covariance_.plus()(first + i, d_);
            gain_minus[i] = weight * covariance_.minus()(first + i, d_);
            f[i] = std::sqrt(first_squares_[first + i]);
        }
        // K = 2 j + parity with parity = 1 for even d, 0 for odd. C- alternates in sign with l.
        const int j = first + (d_ + 1) / 2;
        const Group K_squared = K.square();
        const Group even = gain_plus + gain_minus, odd = gain_plus - gain_minus;
        Group f_before = Group::Zero();
        Group root_here = inverse_root_.col(d_).segment<kGroup>(j);
        for (int l = d_; l <= L_; ++l) {
            const Group square = f.square();
            moments[l] += folded((l - d_) % 2 == 0 ? Group(square * even) : Group(square * odd));
            if (l == L_) break;
            const Group root_next = inverse_root_.col(l + 1).segment<kGroup>(j);
            const double alpha = 2 * (2 * l + 1) / e_[l + 1];
            const double beta = e_[l] / e_[l + 1];
            const double l_squared = static_cast<double>(l) * l;
            const Group next =
                root_next * (alpha * f - (beta * f_before) * ((K_squared - l_squared) * root_here));
            f_before = f;
            f = next;
            root_here = root_next;
        }
    }

  private:
    const BandCovariance& covariance_;
    const Eigen::ArrayXd& first_squares_;
    const Eigen::ArrayXXd& inverse_root_;
    int d_, L_;
    std::vector<double> e_;  // sqrt(l^2 - d^2)
};

}  // namespace

BandCovariance::BandCovariance(int terms, int width)
    : plus_(Matrix::Zero(terms + 1, width + 1)), minus_(plus_) {}

template <typename Scalar>
void BandCovariance::add(const SphereBlockOf<Scalar>& block) {
    const int columns = 2 * block.size;
    add_band(block.U, block.terms, columns, plus_);
    add_band(block.V, block.terms, columns, minus_);
}

template void BandCovariance::add(const SphereBlockOf<float>&);
template void BandCovariance::add(const SphereBlockOf<double>&);

void BandCovariance::add(const BandCovariance& other) {
    plus_ += other.plus_;
    minus_ += other.minus_;
}

void BandCovariance::scale(double factor) {
    plus_ *= factor;
    minus_ *= factor;
}

MomentTransform::MomentTransform(int terms, int width, const Executor& run)
    : terms_(terms), width_(width) {
    run(2, [&](int parity) {
        inverse_roots_[parity] = inverse_roots(terms + width + kGroup, width, parity);
    });
}

std::vector<double> MomentTransform::operator()(const BandCovariance& covariance,
                                                const Executor& run) const {
    const int L = width_;
    const int terms = terms_;
    FirstSquares first_squares(terms + kGroup + 1);
    const int diagonals = std::min(L, terms - 1) + 1;
    std::vector<Lane> sums(L + 1, Lane::Zero());
    for (int first_d = 0; first_d < diagonals; first_d += kDiagonalsAtOnce) {
        const int count = std::min(kDiagonalsAtOnce, diagonals - first_d);
        std::vector<Eigen::ArrayXd> squares;
        for (int i = 0; i < count; ++i, first_squares.next()) {
            squares.push_back(first_squares.values());
        }
        const int jobs = (count + kDiagonalsPerJob - 1) / kDiagonalsPerJob;
        std::vector<std::vector<Lane>> parts(jobs, std::vector<Lane>(L + 1, Lane::Zero()));
        run(jobs, [&](int job) {
            const int end = std::min(count, (job + 1) * kDiagonalsPerJob);
            for (int i = job * kDiagonalsPerJob; i < end; ++i) {
                const int d = first_d + i;
                const OneDiagonal diagonal(covariance, d, squares[i],
                                           inverse_roots_[d % 2 == 0 ? 1 : 0]);
                for (int first = 1; first + d <= terms; first += kGroup) {
                    diagonal.add_orders_from(first, parts[job]);
                }
            }
        });
        for (const auto& part : parts) {
            for (int l = first_d; l <= L; ++l) sums[l] += part[l];
        }
    }
    std::vector<double> moments;
    moments.reserve(sums.size());
    for (const Lane& sum : sums) moments.push_back(sum.sum());
    return moments;
}

}  // namespace miebrdf::mie
