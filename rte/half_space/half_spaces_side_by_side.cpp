#include "rte/half_space/half_spaces_side_by_side.h"

#include <algorithm>
#include <cmath>

#include "rte/half_space/half_space.h"
#include "rte/half_space/pairs_side_by_side.h"
#include "rte/half_space/sweeps.h"
#include "rte/math/matrices_side_by_side.h"
#include "rte/math/means_side_by_side.h"

namespace miebrdf::rte {

const Eigen::MatrixXd* HalfSpacesSideBySide::multiple(int fourier_order) const {
    const int which = fourier_order - first_;
    if (which < 0 || which >= count_ || !has_arrived_[std::size_t(which)]) return nullptr;
    return &multiple_[std::size_t(which)];
}

#ifdef MIEBRDF_HAS_FOUR_DOUBLES

namespace {

using math::kLanes;
using math::multiply_each;

// Matrices in memory, of which each takes as much as the largest.
enum Place : std::size_t {
    kEven,  // kernels E and O between nodes, and below them those from nodes to cosines: two each
    kOdd = kEven + 2,
    kSameSide = kOdd + 2,
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
    kZInverse,
    kPlaces
};

constexpr int kMostSweeps = 40;
// What is left to go has the same sign in many orders.
constexpr double kShareOfEach = 0.3;

template <typename Doubles>
Doubles in_lanes(const std::array<double, HalfSpacesSideBySide::kMostOrders>& values) {
    Doubles lanes;
    for (int k = 0; k < kLanes<Doubles>; ++k) lanes[k] = values[std::size_t(k)];
    return lanes;
}

// Whether all orders have arrived after steps of this size, of which the next one is `ratio` of it.
template <typename Doubles>
bool note_arrivals(const Doubles& step, const Doubles& ratio,
                   const std::array<double, HalfSpacesSideBySide::kMostOrders>& accuracy,
                   std::array<bool, HalfSpacesSideBySide::kMostOrders>& has_arrived) {
    bool have_all = true;
    for (int k = 0; k < kLanes<Doubles>; ++k) {
        const auto order = std::size_t(k);
        has_arrived[order] = left_after(step[k], std::min(ratio[k], 0.9)) <= accuracy[order];
        have_all = have_all && has_arrived[order];
    }
    return have_all;
}

}  // namespace

template <typename Doubles>
Doubles* HalfSpacesSideBySide::matrix(std::size_t which) {
    static_assert(EIGEN_MAX_ALIGN_BYTES >= sizeof(Doubles), "vectors of Eigen's hold registers");
    return reinterpret_cast<Doubles*>(memory_.data() + Eigen::Index(which) * matrix_size_);
}

int HalfSpacesSideBySide::lanes_of(int orders) {
#ifdef MIEBRDF_HAS_EIGHT_DOUBLES
    if (orders > kLanes<math::FourDoubles>) return kLanes<math::EightDoubles>;
#else
    static_cast<void>(orders);
#endif
    return kLanes<math::FourDoubles>;
}

int HalfSpacesSideBySide::most_nodes() {
#ifdef MIEBRDF_HAS_EIGHT_DOUBLES
    return 32;
#else
    return 64;
#endif
}

bool HalfSpacesSideBySide::solve(int first, const ProblemSideBySide& problem) {
    clear();
    const RequestedDirections& requested = problem.requested;
    const std::size_t cosines =
        std::max({std::size_t(requested.mu.size()), requested.out.size(), requested.in.size()});
    if (problem.grid.size() > most_nodes() || cosines > kMostCosines) return false;
    // Nor is there anything to gain from sweeps (half_space.h).
    if (first == 0 && problem.one_minus_albedo < kLeastAbsorption) return false;
#ifdef MIEBRDF_HAS_EIGHT_DOUBLES
    if (lanes_of(problem.orders) == kLanes<math::EightDoubles>)
        return solve_with<math::EightDoubles>(first, problem);
#endif
    return solve_with<math::FourDoubles>(first, problem);
}

template <typename Doubles>
ReflectorSideBySide<Doubles> HalfSpacesSideBySide::reflector() {
    return {matrix<Doubles>(kX), matrix<Doubles>(kReflected), matrix<Doubles>(kPairs)};
}
template ReflectorSideBySide<math::FourDoubles> HalfSpacesSideBySide::reflector();
#ifdef MIEBRDF_HAS_EIGHT_DOUBLES
template ReflectorSideBySide<math::EightDoubles> HalfSpacesSideBySide::reflector();
#endif

template <typename Doubles>
bool HalfSpacesSideBySide::solve_with(int first, const ProblemSideBySide& problem) {
    const RequestedDirections& requested = problem.requested;
    first_ = first;
    lanes_ = kLanes<Doubles>;
    set_grid(problem);
    const Eigen::Index n = nodes_;
    const auto most = Eigen::Index(std::max(
        {requested.out.size(), requested.in.size(), std::size_t(cosines_), std::size_t(nodes_)}));
    matrix_size_ = std::max({n * n, cosines_ * n, most * most}) * lanes_;
    if (memory_.size() < Eigen::Index(kPlaces) * matrix_size_)
        memory_.resize(Eigen::Index(kPlaces) * matrix_size_);
    problem.kernels.form(first, problem.strengths, requested, problem.modes, matrix<Doubles>(kEven),
                         matrix<Doubles>(kOdd), matrix<Doubles>(kGain));
    problem.kernels.form_sides(matrix<Doubles>(kEven), matrix<Doubles>(kOdd),
                               matrix<Doubles>(kSameSide), matrix<Doubles>(kOppositeSide),
                               matrix<Doubles>(kSameSideRows), matrix<Doubles>(kOppositeSideRows));
    find_accuracies<Doubles>(first, problem);
    const bool sweeps = few_sweeps_suffice();
    if (sweeps) {
        start_from_nothing<Doubles>();
    } else if (!start_from_means<Doubles>()) {
        return false;
    }
    sweep_nodes<Doubles>();
    if (sweeps) {
        sweep_rows<Doubles>();
    } else {
        solve_rows<Doubles>();
    }
    count_ = std::min(lanes_, int(problem.strengths.size()) - first);
    find_pairs<Doubles>(requested);
    return has_arrived_[0];
}

void HalfSpacesSideBySide::set_grid(const ProblemSideBySide& problem) {
    const ZenithGrid& grid = problem.grid;
    problem.kernels.set(grid, problem.requested.mu, int(problem.strengths.size()));
    requested_ = problem.requested.mu;
    nodes_ = int(grid.size());
    cosines_ = int(requested_.size());
    inverse_mu_ = grid.mu.cwiseInverse();
    mu_over_flux_weights_ = grid.mu.cwiseQuotient(flux_weights(grid));
    to_nodes_.resize(nodes_, nodes_);
    for (Eigen::Index q = 0; q < nodes_; ++q)
        to_nodes_.col(q) = 0.5 / (inverse_mu_.array() + inverse_mu_[q]);
}

template <typename Doubles>
void HalfSpacesSideBySide::find_accuracies(int first, const ProblemSideBySide& problem) {
    const Doubles* B = matrix<Doubles>(kOppositeSide);
    Doubles once = {};
    for (int q = 0; q < nodes_; ++q) {
        Doubles at_column = {};
        for (int p = 0; p < nodes_; ++p) {
            at_column = math::larger(at_column,
                                     math::absolute(B[p + q * nodes_]) * mu_over_flux_weights_[p]);
        }
        once = math::larger(once, at_column * mu_over_flux_weights_[q]);
    }
    for (int k = 0; k < lanes_; ++k) {
        const auto order = std::size_t(k);
        once_[order] = once[k];
        accuracy_[order] = kShareOfEach * problem.tolerance *
                           std::max(once[k], kShareOfOrderZero * problem.brightness);
        ratio_[order] = 0.0;
        for (Eigen::Index l = first + k; l < problem.strengths.size(); ++l) {
            ratio_[order] =
                std::max(ratio_[order], std::abs(problem.strengths[l]) / (2.0 * double(l) + 1.0));
        }
    }
}

// Where the means of matrices take longer.
bool HalfSpacesSideBySide::few_sweeps_suffice() const {
    constexpr double most_sweeps = 8.0;
    for (std::size_t k = 0; k < std::size_t(lanes_); ++k) {
        if (once_[k] > 0.0 && !arrives_within(most_sweeps, ratio_[k], accuracy_[k] / once_[k]))
            return false;
    }
    return true;
}

template <typename Doubles>
void HalfSpacesSideBySide::start_from_nothing() {
    const Doubles* B = matrix<Doubles>(kOppositeSide);
    Doubles *X = matrix<Doubles>(kX), *psi = matrix<Doubles>(kPsi);
    for (int k = 0; k < nodes_ * nodes_; ++k) {
        psi[k] = B[k];
        X[k] = B[k] * to_nodes_.data()[k];
    }
}

// Where they take fewer operations. With U and V of half_space.h, (I + Z)^-1 = W gives X = 2 W - I.
template <typename Doubles>
bool HalfSpacesSideBySide::start_from_means() {
    const int n = nodes_, rows = nodes_ + cosines_, size = n * n;
    Doubles *Z = matrix<Doubles>(kX), *Z_inverse = matrix<Doubles>(kZInverse);
    const Doubles *even = matrix<Doubles>(kEven), *odd = matrix<Doubles>(kOdd);
    for (int q = 0; q < n; ++q) {
        for (int p = q; p < n; ++p) {
            Z[p + q * n] = -even[p + q * rows];
            Z_inverse[p + q * n] = -odd[p + q * rows];
        }
        Z[q + q * n] += inverse_mu_[q];
        Z_inverse[q + q * n] += inverse_mu_[q];
    }
    // U and V lie between (1 - q) M^-1 and (1 + q) M^-1.
    double share = 1.0, most = 0.0;
    for (std::size_t k = 0; k < std::size_t(lanes_); ++k) {
        most = std::max(most, ratio_[k]);
        if (once_[k] > 0.0) share = std::min(share, accuracy_[k] / once_[k]);
    }
    const double lowest = std::max(1.0 - most, 1e-6), highest = inverse_mu_[0];
    Doubles* memory = matrix<Doubles>(kGain);  // with kProduct and kPsi, which are not in use yet
    if (!math::find_geometric_means(Z, Z_inverse, n, lowest, highest, 0.1 * share, memory))
        return false;
    for (int q = 0; q < n; ++q) {
        Z[q + q * n] += 1.0;
        for (int p = q; p < n; ++p) Z_inverse[q + p * n] = Z_inverse[p + q * n];
    }
    math::invert_each(Z, n, memory);
    Doubles *X = Z, *psi = matrix<Doubles>(kPsi);
    for (int k = 0; k < size; ++k) X[k] *= 2.0;
    for (int q = 0; q < n; ++q) X[q + q * n] -= 1.0;
    for (int q = 0; q < n; ++q)
        for (int p = 0; p < n; ++p)
            psi[p + q * n] = X[p + q * n] * (2.0 * (inverse_mu_[p] + inverse_mu_[q]));
    once_.fill(1e300);  // no step has been made yet
    return true;
}

// X by the fixed point of half_space.cpp.
template <typename Doubles>
void HalfSpacesSideBySide::sweep_nodes() {
    const int n = nodes_, size = n * n;
    const Doubles *A = matrix<Doubles>(kSameSide), *B = matrix<Doubles>(kOppositeSide);
    Doubles *X = matrix<Doubles>(kX), *G = matrix<Doubles>(kGain), *XG = matrix<Doubles>(kProduct),
            *psi = matrix<Doubles>(kPsi);
    const double* to_nodes = to_nodes_.data();
    const Eigen::VectorXd& bounded = mu_over_flux_weights_;
    const Doubles ratio = in_lanes<Doubles>(ratio_);
    Doubles step = in_lanes<Doubles>(once_), slowest = ratio;
    for (int sweep = 0; !note_arrivals(step, slowest, accuracy_, has_arrived_); ++sweep) {
        if (sweep == kMostSweeps) return;
        for (int k = 0; k < size; ++k) G[k] = 2.0 * A[k];
        multiply_each<true>(B, X, G, n, n, n);
        multiply_each<false>(X, G, XG, n, n, n);
        Doubles next = {};
        for (int q = 0; q < n; ++q) {
            Doubles at_column = {};
            for (int p = 0; p <= q; ++p) {
                const int here = p + q * n, across = q + p * n;
                const Doubles sum = B[here] + 0.5 * (XG[here] + XG[across]);
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
template <typename Doubles>
void HalfSpacesSideBySide::sweep_rows() {
    const int n = nodes_, cosines = cosines_;
    Doubles *gain = matrix<Doubles>(kGain), *seen = matrix<Doubles>(kSeen),
            *reflected = matrix<Doubles>(kReflected);
    Doubles *rows = matrix<Doubles>(kRows), *next_rows = matrix<Doubles>(kNextRows);
    std::copy_n(matrix<Doubles>(kSameSide), n * n, gain);
    multiply_each<true>(matrix<Doubles>(kOppositeSide), matrix<Doubles>(kX), gain, n, n, n);
    std::copy_n(matrix<Doubles>(kOppositeSideRows), cosines * n, seen);
    multiply_each<true>(matrix<Doubles>(kSameSideRows), matrix<Doubles>(kX), seen, cosines, n, n);
    // mu times the rows is what the pairs need, too.
    const auto reflect = [&] {
        for (int q = 0; q < n; ++q) {
            for (int i = 0; i < cosines; ++i) {
                const double mu = requested_[i];
                reflected[i + q * cosines] =
                    rows[i + q * cosines] * (0.5 * mu / (1.0 + inverse_mu_[q] * mu));
            }
        }
    };
    std::copy_n(seen, cosines * n, rows);
    reflect();
    const Doubles ratio = in_lanes<Doubles>(ratio_);
    Doubles step = in_lanes<Doubles>(once_);
    std::array<bool, kMostOrders> have_rows = {};
    for (int sweep = 0; !note_arrivals(step, ratio, accuracy_, have_rows); ++sweep) {
        if (sweep == kMostSweeps) break;
        std::copy_n(seen, cosines * n, next_rows);
        multiply_each<true>(reflected, gain, next_rows, cosines, n, n);
        step = Doubles{};
        for (int q = 0; q < n; ++q) {
            Doubles at_column = {};
            for (int i = q * cosines; i < (q + 1) * cosines; ++i)
                at_column = math::larger(at_column, math::absolute(next_rows[i] - rows[i]));
            step = math::larger(step, at_column * mu_over_flux_weights_[q]);
        }
        std::swap(rows, next_rows);
        reflect();
    }
    for (std::size_t k = 0; k < std::size_t(lanes_); ++k)
        has_arrived_[k] = has_arrived_[k] && have_rows[k];
}

// The rows of the closed form without its eigenmodes: 2 R(mu, .) D = r_mu (I + X) / 2 with
// r_mu (Z^-1 + mu V) = (E Z^-1 - O) at the cosine.
template <typename Doubles>
void HalfSpacesSideBySide::solve_rows() {
    const int n = nodes_, cosines = cosines_, all = nodes_ + cosines_;
    const Doubles *even = matrix<Doubles>(kEven), *odd = matrix<Doubles>(kOdd),
                  *Z_inverse = matrix<Doubles>(kZInverse);
    Doubles *sources = matrix<Doubles>(kNextRows), *solved = matrix<Doubles>(kRows),
            *system = matrix<Doubles>(kGain), *half = matrix<Doubles>(kProduct),
            *row = matrix<Doubles>(kSeen), *reflected = matrix<Doubles>(kReflected);
    for (int q = 0; q < n; ++q)
        for (int i = 0; i < cosines; ++i) sources[i + q * cosines] = -odd[n + i + q * all];
    multiply_each<true>({even + n, all}, {Z_inverse, 1, n}, sources, cosines, n, n, cosines);
    for (int i = 0; i < cosines; ++i) {
        const double mu = requested_[i];
        for (int q = 0; q < n; ++q) {
            for (int p = q; p < n; ++p)
                system[p + q * n] = Z_inverse[p + q * n] - mu * odd[p + q * all];
            system[q + q * n] += mu * inverse_mu_[q];
            row[q] = sources[i + q * cosines];
        }
        math::solve_each(system, row, n);
        for (int q = 0; q < n; ++q) solved[i + q * cosines] = mu * row[q];
    }
    const Doubles* X = matrix<Doubles>(kX);
    for (int k = 0; k < n * n; ++k) half[k] = 0.5 * X[k];
    for (int q = 0; q < n; ++q) half[q + q * n] += 0.5;
    multiply_each<false>(solved, half, reflected, cosines, n, n);
}

// 4 (mu_o + mu_i) R = T_o (A_i + T_i B)^T + A_o T_i^T with T = mu times the rows.
template <typename Doubles>
void HalfSpacesSideBySide::find_pairs(const RequestedDirections& requested) {
    const int n = nodes_, cosines = cosines_;
    const int out = int(requested.out.size()), in = int(requested.in.size());
    const Doubles *T = matrix<Doubles>(kReflected), *A = matrix<Doubles>(kSameSideRows);
    Doubles *sum = matrix<Doubles>(kSeen), *pairs = matrix<Doubles>(kPairs);
    std::copy_n(A, cosines * n, sum);
    multiply_each<true>(T, matrix<Doubles>(kOppositeSide), sum, cosines, n, n);
    Doubles *gathered_out = matrix<Doubles>(kOut), *gathered_in = matrix<Doubles>(kIn);
    multiply_pairs<false>(T, sum, n, requested, gathered_out, gathered_in, pairs);
    multiply_pairs<true>(A, T, n, requested, gathered_out, gathered_in, pairs);
    divide_by_cosines(requested, pairs);
    for (std::size_t k = 0; k < std::size_t(count_); ++k) {
        Eigen::MatrixXd& multiple = multiple_[k];
        multiple.resize(out, in);
        for (int p = 0; p < out * in; ++p) multiple.data()[p] = pairs[p][k];
        has_arrived_[k] = has_arrived_[k] && multiple.allFinite();
    }
}

double HalfSpacesSideBySide::brightness() const {
    const double* psi = memory_.data() + Eigen::Index(kPsi) * matrix_size_;
    double brightness = 0.0;
    for (Eigen::Index q = 0; q < nodes_; ++q) {
        for (Eigen::Index p = 0; p <= q; ++p) {
            brightness =
                std::max(brightness, std::abs(psi[(p + q * nodes_) * lanes_]) *
                                         mu_over_flux_weights_[p] * mu_over_flux_weights_[q]);
        }
    }
    return brightness;
}

#else

int HalfSpacesSideBySide::lanes_of(int) { return 0; }
int HalfSpacesSideBySide::most_nodes() { return 0; }
bool HalfSpacesSideBySide::solve(int, const ProblemSideBySide&) { return false; }
double HalfSpacesSideBySide::brightness() const { return 0.0; }

#endif

}  // namespace miebrdf::rte
