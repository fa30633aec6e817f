#include "mie/ensemble/moment_transform.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace miebrdf::mie {
namespace {

// Rows of a tile: products of tile x (tile + width) blocks waste half a tile squared each, but
// narrower ones run slower.
constexpr int kTileRows = 32;

template <typename Scalar>
void add_band(const SphereBlockOf<Scalar>& block,
              const typename SphereBlockOf<Scalar>::Matrix& waves, BandCovariance::Matrix& band) {
    const int terms = block.terms;
    const int width = static_cast<int>(band.cols()) - 1;
    typename SphereBlockOf<Scalar>::Matrix tile;
    for (int n = 1; n <= terms; n += kTileRows) {
        const int rows = std::min(kTileRows, terms - n + 1);
        const int reach = std::min(rows + width, terms - n + 1);
        const auto part = [&](int column, int count) {
            return waves.block(n, column, count, block.size);
        };
        tile.noalias() = part(0, rows) * part(0, reach).transpose();
        tile.noalias() += part(block.imaginary, rows) * part(block.imaginary, reach).transpose();
        for (int i = 0; i < rows; ++i) {
            const int count = std::min(width + 1, reach - i);
            band.row(n + i).head(count) += tile.row(i).segment(i, count).template cast<double>();
        }
    }
}

// Orders n handled together; enough independent recurrences to hide the latency of each. As many
// orders interpolate those from the width on, which errs by 5.8^-16 = 6e-13.
constexpr int kGroup = 16;
constexpr int kDiagonalsPerJob = 8;
using Group = Eigen::Array<double, kGroup, 1>;
using Lane = Eigen::Array<double, 8, 1>;

Lane folded(const Group& g) { return g.segment<8>(0) + g.segment<8>(8); }

int whole_groups(int orders) { return (orders + kGroup - 1) / kGroup * kGroup; }

// 1 / sqrt(K^2 - l^2), 0 for l >= K: there the 3j symbol vanishes. Column l.
void fill_inverse_roots(const Eigen::ArrayXd& K, Eigen::ArrayXXd& table) {
    for (Eigen::Index l = 0; l < table.cols(); ++l) {
        const double last = static_cast<double>(l);
        table.col(l) = (K > last).select(((K - last) * (K + last)).abs().rsqrt(), 0.0);
    }
}

// (2n + 1) f_d^2 for m = n + d, all n at once: from 1 at d = 0 by its ratio from d to d + 1.
class FirstSquares {
  public:
    explicit FirstSquares(const Eigen::ArrayXd& orders)
        : n_(orders), square_(Eigen::ArrayXd::Ones(orders.size())) {}

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

// The recurrence for one d = |n - m|.
class OneDiagonal {
  public:
    OneDiagonal(int d, int width) : d_(d), L_(width) {
        for (int l = 0; l <= L_ + 1; ++l) {
            e_.push_back(l > d ? std::sqrt(static_cast<double>(l - d) * (l + d)) : 0.0);
        }
    }

    // Adds a group of orders to moments, eight partial sums per l.
    // roots: 1 / sqrt(K^2 - l^2), column l, from this row on.
    void add(const Group& K, const Group& first_squares, const Group& plus, const Group& minus,
             const Eigen::ArrayXXd& roots, Eigen::Index row, std::vector<Lane>& moments) const {
        const double sides = d_ == 0 ? 1 : 2;  // m = n + d and m = n - d
        const Group K_squared = K.square();
        // C- alternates in sign with l.
        const Group even = sides * (plus + minus), odd = sides * (plus - minus);
        Group f = first_squares.sqrt();
        Group f_before = Group::Zero();
        Group root_here = roots.col(d_).segment<kGroup>(row);
        for (int l = d_; l <= L_; ++l) {
            const Group square = f.square();
            moments[l] += folded((l - d_) % 2 == 0 ? Group(square * even) : Group(square * odd));
            if (l == L_) break;
            const Group root_next = roots.col(l + 1).segment<kGroup>(row);
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
    int d_, L_;
    std::vector<double> e_;  // sqrt(l^2 - d^2)
};

}  // namespace

BandCovariance::BandCovariance(int terms, int width)
    : plus_(Matrix::Zero(terms + 1, width + 1)), minus_(plus_) {}

template <typename Scalar>
void BandCovariance::add(const SphereBlockOf<Scalar>& block) {
    add_band(block, block.U, plus_);
    add_band(block, block.V, minus_);
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

MomentTransform::MomentTransform(int terms, int width)
    : terms_(terms), width_(width), direct_(terms) {
    const int enough = whole_groups(width);
    if (enough + 2 * kGroup < terms) direct_ = enough;
    for (int n = 1; n <= direct_; ++n) orders_.push_back(n);
    const int rows = whole_groups(direct_) + width / 2 + 1;
    for (const int parity : {0, 1}) {
        inverse_roots_[parity].resize(rows, width + 1);
        fill_inverse_roots(2 * Eigen::ArrayXd::LinSpaced(rows, 1, rows) + parity,
                           inverse_roots_[parity]);
    }
    if (direct_ == terms) return;
    // Chebyshev points of 1/n between those of the first and the last order.
    const double low = 1.0 / terms, high = 1.0 / direct_;
    places_.resize(kGroup);
    barycentric_.resize(kGroup);
    for (int i = 0; i < kGroup; ++i) {
        const double angle = std::numbers::pi * (i + 0.5) / kGroup;
        places_[i] = 0.5 * (low + high) + 0.5 * (high - low) * std::cos(angle);
        barycentric_[i] = (i % 2 == 0 ? 1 : -1) * std::sin(angle);
        orders_.push_back(1 / places_[i]);
    }
}

Eigen::VectorXd MomentTransform::shares(double n) const {
    const Eigen::ArrayXd distance = 1 / n - places_.array();
    Eigen::Index nearest = 0;
    if (distance.abs().minCoeff(&nearest) < 1e-14 / n) {
        return Eigen::VectorXd::Unit(kGroup, nearest);
    }
    const Eigen::VectorXd terms = barycentric_.array() / distance;
    return terms / terms.sum();
}

std::vector<double> MomentTransform::operator()(const BandCovariance& covariance,
                                                const Executor& run) const {
    Eigen::MatrixXd shares_of_rows(interpolating(), terms_ - direct_);
    for (int n = direct_ + 1; n <= terms_; ++n) shares_of_rows.col(n - direct_ - 1) = shares(n);
    Collected collected;
    const auto collect = [&](const BandCovariance::Matrix& band, Eigen::MatrixXd& to) {
        to.resize(order_count(), width_ + 1);
        BandCovariance::Matrix weighted(terms_, width_ + 1);
        const Eigen::RowVectorXd twice_d = Eigen::RowVectorXd::LinSpaced(width_ + 1, 0, 2 * width_);
        for (int n = 1; n <= terms_; ++n) {
            weighted.row(n - 1) =
                band.row(n).array() * (twice_d.array() + static_cast<double>(2 * n + 1));
        }
        to.topRows(direct_) = weighted.topRows(direct_);
        to.bottomRows(interpolating()).noalias() =
            shares_of_rows * weighted.bottomRows(terms_ - direct_);
    };
    collect(covariance.plus(), collected.plus);
    collect(covariance.minus(), collected.minus);
    return (*this)(collected, run);
}

std::vector<double> MomentTransform::operator()(const Collected& collected,
                                                const Executor& run) const {
    const int rows = whole_groups(order_count());
    Eigen::ArrayXd orders = Eigen::ArrayXd::LinSpaced(rows, 1, rows);  // filled up with more
    orders.head(order_count()) = Eigen::Map<const Eigen::ArrayXd>(orders_.data(), order_count());
    const int diagonals = std::min(width_, terms_ - 1) + 1;
    std::vector<Eigen::ArrayXd> squares;
    for (FirstSquares first_squares(orders); static_cast<int>(squares.size()) < diagonals;
         first_squares.next()) {
        squares.push_back(first_squares.values());
    }
    const int jobs = (diagonals + kDiagonalsPerJob - 1) / kDiagonalsPerJob;
    std::vector<std::vector<Lane>> parts(jobs, std::vector<Lane>(width_ + 1, Lane::Zero()));
    run(jobs, [&](int job) {
        Eigen::ArrayXd plus = Eigen::ArrayXd::Zero(rows), minus = plus;
        Eigen::ArrayXXd roots_between(kGroup, interpolating() > 0 ? width_ + 1 : 0);
        const int end = std::min(diagonals, (job + 1) * kDiagonalsPerJob);
        for (int d = job * kDiagonalsPerJob; d < end; ++d) {
            plus.head(order_count()) = collected.plus.col(d);
            minus.head(order_count()) = collected.minus.col(d);
            const OneDiagonal diagonal(d, width_);
            const auto add = [&](int first, const Eigen::ArrayXXd& roots, Eigen::Index row) {
                const Group K = 2 * orders.segment<kGroup>(first) + (d + 1);
                diagonal.add(K, squares[d].segment<kGroup>(first), plus.segment<kGroup>(first),
                             minus.segment<kGroup>(first), roots, row, parts[job]);
            };
            // K = 2n + d + 1 = 2 (row + 1) + parity.
            const int parity = d % 2 == 0 ? 1 : 0;
            for (int first = 0; first < direct_; first += kGroup) {
                add(first, inverse_roots_[parity], first + d / 2 + (1 - parity));
            }
            if (interpolating() == 0) continue;
            fill_inverse_roots(2 * orders.tail<kGroup>() + (d + 1), roots_between);
            add(direct_, roots_between, 0);
        }
    });
    std::vector<double> moments(width_ + 1, 0.0);
    for (int l = 0; l <= width_; ++l) {
        for (const auto& part : parts) moments[l] += part[l].sum();
    }
    return moments;
}

}  // namespace miebrdf::mie
