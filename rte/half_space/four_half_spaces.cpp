#include "rte/half_space/four_half_spaces.h"

#include <algorithm>
#include <cmath>

#include "rte/fourier/eigenmodes.h"
#include "rte/half_space/sweeps.h"
#include "rte/math/four_doubles.h"

namespace miebrdf::rte {

const Eigen::MatrixXd* FourHalfSpaces::multiple(int fourier_order) const {
    const int which = fourier_order - first_;
    if (first_ == 0 || which < 0 || which >= count_ || !has_arrived_[std::size_t(which)])
        return nullptr;
    return &multiple_[std::size_t(which)];
}

#ifdef MIEBRDF_HAS_FOUR_DOUBLES

namespace {

using math::FourDoubles;

// Matrices in memory, of which each takes as much as the largest.
enum Place : std::size_t {
    kSameSide,
    kOppositeSide,
    kX,
    kGain,
    kProduct,
    kPsi,
    kSameSideRows,
    kOppositeSideRows,
    kSeen,
    kRows,
    kNextRows,
    kReflected,
    kOut,
    kIn,
    kPairs,
    kPlaces
};

constexpr int kMostSweeps = 40;

FourDoubles* four(double* matrix) { return reinterpret_cast<FourDoubles*>(matrix); }

FourDoubles four(const std::array<double, FourHalfSpaces::kOrders>& values) {
    return FourDoubles{values[0], values[1], values[2], values[3]};
}

// Whether all orders have arrived after steps of this size, of which the next one is `ratio` of it.
bool note_arrivals(const FourDoubles& step, const FourDoubles& ratio,
                   const std::array<double, FourHalfSpaces::kOrders>& accuracy,
                   std::array<bool, FourHalfSpaces::kOrders>& has_arrived) {
    bool have_all = true;
    for (std::size_t k = 0; k < has_arrived.size(); ++k) {
        has_arrived[k] = left_after(step[k], std::min(ratio[k], 0.9)) <= accuracy[k];
        have_all = have_all && has_arrived[k];
    }
    return have_all;
}

// Rows of a table, and the same transposed.
void gather_four(const FourDoubles* rows, int count, int columns, const std::vector<int>& which,
                 FourDoubles* result) {
    for (int c = 0; c < columns; ++c)
        for (const int row : which) *result++ = rows[row + c * count];
}

void transpose_four(const FourDoubles* rows, int count, int columns, const std::vector<int>& which,
                    FourDoubles* result) {
    for (const int row : which)
        for (int c = 0; c < columns; ++c) *result++ = rows[row + c * count];
}

}  // namespace

double* FourHalfSpaces::matrix(std::size_t which) {
    return memory_.data() + Eigen::Index(which) * matrix_size_;
}

bool FourHalfSpaces::begin(int first, Eigen::Index nodes, const RequestedDirections& requested) {
    clear();
    const std::size_t cosines =
        std::max({std::size_t(requested.mu.size()), requested.out.size(), requested.in.size()});
    if (nodes > kMostNodes || cosines > kMostCosines) return false;
    first_ = first;
    count_ = 0;
    nodes_ = int(nodes);
    cosines_ = int(requested.mu.size());
    const Eigen::Index largest = std::max(nodes, Eigen::Index(cosines));
    matrix_size_ = largest * largest * kOrders;
    if (memory_.size() < Eigen::Index(kPlaces) * matrix_size_)
        memory_.resize(Eigen::Index(kPlaces) * matrix_size_);
    has_arrived_.fill(false);
    once_.fill(0.0);
    accuracy_.fill(0.0);
    ratio_.fill(0.0);
    return true;
}

bool FourHalfSpaces::add(const FourierMedium& medium, double tolerance, const FourierWork& work) {
    // Where four at once take as long as eigenmodes one by one.
    constexpr double most_sweeps = 24.0;
    const auto order = std::size_t(count_);
    double once = 0.0;
    for (Eigen::Index q = 0; q < nodes_; ++q) {
        once = std::max(
            once, (work.opposite_side.col(q).array().abs() * work.mu_over_flux_weights.array())
                          .maxCoeff() *
                      work.mu_over_flux_weights[q]);
    }
    once_[order] = once;
    accuracy_[order] = tolerance * std::max(once, kShareOfOrderZero * medium.brightness);
    ratio_[order] = medium.strongest();
    if (once > 0.0 && !arrives_within(most_sweeps, ratio_[order], accuracy_[order] / once))
        return false;
    const auto put = [&](const Eigen::MatrixXd& from, Place place) {
        double* to = matrix(place) + order;
        for (Eigen::Index k = 0; k < from.size(); ++k) to[k * kOrders] = from.data()[k];
    };
    put(work.same_side, kSameSide);
    put(work.opposite_side, kOppositeSide);
    put(work.same_side_rows, kSameSideRows);
    put(work.opposite_side_rows, kOppositeSideRows);
    ++count_;
    return true;
}

// X by the fixed point of half_space.cpp.
void FourHalfSpaces::sweep_nodes(const FourierWork& work) {
    const int n = nodes_, size = n * n;
    const FourDoubles *A = four(matrix(kSameSide)), *B = four(matrix(kOppositeSide));
    FourDoubles *X = four(matrix(kX)), *G = four(matrix(kGain)), *XG = four(matrix(kProduct)),
                *psi = four(matrix(kPsi));
    const double* to_nodes = work.to_nodes.data();
    const Eigen::VectorXd& bounded = work.mu_over_flux_weights;
    for (int k = 0; k < size; ++k) {
        psi[k] = B[k];
        X[k] = B[k] * to_nodes[k];
    }
    const FourDoubles ratio = four(ratio_);
    FourDoubles step = four(once_), slowest = ratio;
    for (int sweep = 0; !note_arrivals(step, slowest, accuracy_, has_arrived_); ++sweep) {
        if (sweep == kMostSweeps) return;
        for (int k = 0; k < size; ++k) G[k] = 2.0 * A[k];
        math::multiply_four<true>(B, X, G, n, n, n);
        math::multiply_four<false>(X, G, XG, n, n, n);
        FourDoubles next = {};
        for (int q = 0; q < n; ++q) {
            FourDoubles at_column = {};
            for (int p = 0; p <= q; ++p) {
                const int here = p + q * n, across = q + p * n;
                const FourDoubles sum = B[here] + 0.5 * (XG[here] + XG[across]);
                at_column = math::larger(at_column, math::absolute(sum - psi[here]) * bounded[p]);
                psi[here] = sum;
                X[here] = X[across] = sum * to_nodes[here];
            }
            next = math::larger(next, at_column * bounded[q]);
        }
        slowest = math::larger(ratio, next / (step + 1e-300));
        step = next;
    }
}

// With X known, 2 R(mu, mu_q) D_q at each requested cosine by a linear fixed point of its own.
void FourHalfSpaces::sweep_rows(const RequestedDirections& requested, const FourierWork& work) {
    const int n = nodes_, cosines = cosines_;
    FourDoubles *gain = four(matrix(kGain)), *seen = four(matrix(kSeen)),
                *reflected = four(matrix(kReflected));
    FourDoubles *rows = four(matrix(kRows)), *next_rows = four(matrix(kNextRows));
    std::copy_n(four(matrix(kSameSide)), n * n, gain);
    math::multiply_four<true>(four(matrix(kOppositeSide)), four(matrix(kX)), gain, n, n, n);
    std::copy_n(four(matrix(kOppositeSideRows)), cosines * n, seen);
    math::multiply_four<true>(four(matrix(kSameSideRows)), four(matrix(kX)), seen, cosines, n, n);
    // mu times the rows is what the pairs need, too.
    const auto reflect = [&] {
        for (int q = 0; q < n; ++q) {
            for (int i = 0; i < cosines; ++i) {
                const double mu = requested.mu[i];
                reflected[i + q * cosines] =
                    rows[i + q * cosines] * (0.5 * mu / (1.0 + work.inverse_mu[q] * mu));
            }
        }
    };
    std::copy_n(seen, cosines * n, rows);
    reflect();
    const FourDoubles ratio = four(ratio_);
    FourDoubles step = four(once_);
    std::array<bool, kOrders> have_rows = {};
    for (int sweep = 0; !note_arrivals(step, ratio, accuracy_, have_rows); ++sweep) {
        if (sweep == kMostSweeps) break;
        std::copy_n(seen, cosines * n, next_rows);
        math::multiply_four<true>(reflected, gain, next_rows, cosines, n, n);
        step = FourDoubles{};
        for (int q = 0; q < n; ++q) {
            FourDoubles at_column = {};
            for (int i = q * cosines; i < (q + 1) * cosines; ++i)
                at_column = math::larger(at_column, math::absolute(next_rows[i] - rows[i]));
            step = math::larger(step, at_column * work.mu_over_flux_weights[q]);
        }
        std::swap(rows, next_rows);
        reflect();
    }
    for (std::size_t k = 0; k < kOrders; ++k) has_arrived_[k] = has_arrived_[k] && have_rows[k];
}

// 4 (mu_o + mu_i) R = T_o (A_i + T_i B)^T + A_o T_i^T with T = mu times the rows.
void FourHalfSpaces::find_pairs(const RequestedDirections& requested) {
    const int n = nodes_, cosines = cosines_;
    const int out = int(requested.out.size()), in = int(requested.in.size());
    const FourDoubles *T = four(matrix(kReflected)), *A = four(matrix(kSameSideRows));
    FourDoubles *sum = four(matrix(kSeen)), *pairs = four(matrix(kPairs));
    std::copy_n(A, cosines * n, sum);
    math::multiply_four<true>(T, four(matrix(kOppositeSide)), sum, cosines, n, n);
    gather_four(T, cosines, n, requested.out, four(matrix(kOut)));
    transpose_four(sum, cosines, n, requested.in, four(matrix(kIn)));
    math::multiply_four<false>(four(matrix(kOut)), four(matrix(kIn)), pairs, out, n, in);
    gather_four(A, cosines, n, requested.out, four(matrix(kOut)));
    transpose_four(T, cosines, n, requested.in, four(matrix(kIn)));
    math::multiply_four<true>(four(matrix(kOut)), four(matrix(kIn)), pairs, out, n, in);
    for (std::size_t k = 0; k < std::size_t(count_); ++k) {
        Eigen::MatrixXd& multiple = multiple_[k];
        multiple.resize(out, in);
        for (int p = 0; p < out * in; ++p) multiple.data()[p] = pairs[p][k];
        divide_by_cosines(requested, multiple);
        has_arrived_[k] = has_arrived_[k] && multiple.allFinite();
    }
}

void FourHalfSpaces::solve(const RequestedDirections& requested, const FourierWork& work) {
    // Degrees may end before the fourth order: nothing is scattered there.
    for (const Place place : {kSameSide, kOppositeSide, kSameSideRows, kOppositeSideRows}) {
        for (int order = count_; order < kOrders; ++order)
            for (Eigen::Index k = order; k < matrix_size_; k += kOrders) matrix(place)[k] = 0.0;
    }
    sweep_nodes(work);
    sweep_rows(requested, work);
    find_pairs(requested);
}

#else

bool FourHalfSpaces::begin(int, Eigen::Index, const RequestedDirections&) { return false; }
bool FourHalfSpaces::add(const FourierMedium&, double, const FourierWork&) { return false; }
void FourHalfSpaces::solve(const RequestedDirections&, const FourierWork&) {}

#endif

}  // namespace miebrdf::rte
