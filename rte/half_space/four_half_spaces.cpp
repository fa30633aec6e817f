#include "rte/half_space/four_half_spaces.h"

#include <algorithm>
#include <cmath>

#include "rte/fourier/eigenmodes.h"
#include "rte/half_space/half_space.h"
#include "rte/half_space/sweeps.h"
#include "rte/math/four_doubles.h"

namespace miebrdf::rte {

const Eigen::MatrixXd* FourHalfSpaces::multiple(int fourier_order) const {
    const int which = fourier_order - first_;
    if (which < 0 || which >= count_ || !has_arrived_[std::size_t(which)]) return nullptr;
    return &multiple_[std::size_t(which)];
}

#ifdef MIEBRDF_HAS_FOUR_DOUBLES

namespace {

using math::FourDoubles;

// Matrices in memory, of which each takes as much as the largest.
enum Place : std::size_t {
    kEven,  // kernels E and O between nodes, and below them those from nodes to cosines
    kOdd,
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
// What is left to go has the same sign in many orders.
constexpr double kShareOfEach = 0.3;

static_assert(EIGEN_MAX_ALIGN_BYTES >= sizeof(FourDoubles), "vectors of Eigen's hold registers");
FourDoubles* four(double* matrix) { return reinterpret_cast<FourDoubles*>(matrix); }
const FourDoubles* four(const double* matrix) {
    return reinterpret_cast<const FourDoubles*>(matrix);
}

FourDoubles four(const std::array<double, FourHalfSpaces::kOrders>& values) {
    return FourDoubles{values[0], values[1], values[2], values[3]};
}

// target = A B or target += A B, all stored by columns.
template <bool add>
void multiply(const FourDoubles* A, const FourDoubles* B, FourDoubles* target, int rows, int inner,
              int columns) {
    math::multiply_four<add>({A, rows}, {B, 1, inner}, target, rows, inner, columns, rows);
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

void put(const Eigen::Ref<const Eigen::VectorXd>& from, std::size_t order, double* to) {
    for (Eigen::Index k = 0; k < from.size(); ++k)
        to[k * FourHalfSpaces::kOrders + Eigen::Index(order)] = from[k];
}

}  // namespace

double* FourHalfSpaces::matrix(std::size_t which) {
    return memory_.data() + Eigen::Index(which) * matrix_size_;
}

bool FourHalfSpaces::solve(int first, const FourProblem& problem, FourierModes& modes) {
    clear();
    const RequestedDirections& requested = problem.requested;
    const std::size_t cosines =
        std::max({std::size_t(requested.mu.size()), requested.out.size(), requested.in.size()});
    if (problem.grid.size() > kMostNodes || cosines > kMostCosines) return false;
    // Slow eigenmodes cost digits here; nor is there anything to gain from sweeps (half_space.h).
    constexpr double least_absorption = 1e-5;
    if (first == 0 && problem.one_minus_albedo < least_absorption) return false;
    first_ = first;
    const double* table = table_of(first, problem, modes);
    const Eigen::Index n = nodes_, rows = nodes_ + cosines_, most = Eigen::Index(cosines);
    matrix_size_ = std::max(rows * n, std::max(most, n) * std::max(most, n)) * kOrders;
    if (memory_.size() < Eigen::Index(kPlaces) * matrix_size_)
        memory_.resize(Eigen::Index(kPlaces) * matrix_size_);
    form_kernels(first, problem, table);
    find_accuracies(first, problem);
    const bool sweeps = few_sweeps_suffice();
    if (sweeps) {
        start_from_nothing();
    } else if (!start_from_means()) {
        return false;
    }
    sweep_nodes();
    if (sweeps) {
        sweep_rows();
    } else {
        solve_rows();
    }
    count_ = std::min(kOrders, int(problem.strengths.size()) - first);
    find_pairs(requested);
    return has_arrived_[0];
}

const double* FourHalfSpaces::table_of(int first, const FourProblem& problem, FourierModes& modes) {
    const auto alike = [](const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
        return a.size() == b.size() && a == b;
    };
    const ZenithGrid& grid = problem.grid;
    const auto degrees = int(problem.strengths.size());
    if (degrees != degrees_ || !alike(grid.mu, grid_.mu) || !alike(grid.weights, grid_.weights) ||
        grid.panels != grid_.panels || !alike(requested_, problem.requested.mu)) {
        degrees_ = degrees;
        grid_ = grid;
        requested_ = problem.requested.mu;
        nodes_ = int(grid.size());
        cosines_ = int(requested_.size());
        inverse_mu_ = grid.mu.cwiseInverse();
        mu_over_flux_weights_ = grid.mu.cwiseQuotient(flux_weights(grid));
        to_nodes_.resize(nodes_, nodes_);
        for (Eigen::Index q = 0; q < nodes_; ++q)
            to_nodes_.col(q) = 0.5 / (inverse_mu_.array() + inverse_mu_[q]);
        tables_.clear();
    }
    for (const Table& table : tables_)
        if (table.first == first) return table.values.data();
    // All together at most 2 MB.
    constexpr Eigen::Index most = 1 << 18;
    const Eigen::Index rows = nodes_ + cosines_, size = rows * (degrees - first) * kOrders;
    const bool is_kept = Eigen::Index(tables_.size() + 1) * size <= most;
    if (is_kept) tables_.emplace_back();
    Table& table = is_kept ? tables_.back() : passing_;
    table.first = first;
    table.values.setZero(size);
    for (int m = first; m < std::min(degrees, first + kOrders); ++m) {
        const FourierMode& mode = modes.find(m, degrees, grid, problem.requested);
        for (Eigen::Index c = 0; c < mode.scaled_nodes.cols(); ++c) {
            double* column = table.values.data() + c * rows * kOrders;
            put(mode.scaled_nodes.col(c), std::size_t(m - first), column);
            put(mode.at_requested.col(c), std::size_t(m - first), column + nodes_ * kOrders);
        }
    }
    return table.values.data();
}

// Column c of the table belongs to the degree m + c of each order m.
void FourHalfSpaces::form_kernels(int first, const FourProblem& problem, const double* table) {
    const int n = nodes_, rows = nodes_ + cosines_, columns = degrees_ - first;
    FourDoubles* weighted = four(matrix(kGain));  // n x degrees of one parity, in free memory
    // So many degrees that they stay in the cache next to the processor.
    const int at_once = std::min(rows, 640 / (rows + n));
    for (const int parity : {0, 1}) {
        FourDoubles* kernel = four(matrix(parity == 0 ? kEven : kOdd));
        std::fill_n(kernel, rows * n, FourDoubles{});
        for (int begin = parity; begin < columns; begin += 2 * at_once) {
            const int count = std::min(at_once, (columns - begin + 1) / 2);
            for (int k = 0; k < count; ++k) {
                const int c = begin + 2 * k;
                FourDoubles strength = {};
                for (int order = 0; order < kOrders && first + order + c < degrees_; ++order)
                    strength[order] = problem.strengths[first + order + c];
                const FourDoubles* column = four(table) + c * rows;
                for (int p = 0; p < n; ++p) weighted[p + k * n] = strength * column[p];
            }
            math::multiply_four<true, math::Part::lower>({four(table) + begin * rows, 2 * rows},
                                                         {weighted, n, 1}, kernel, rows, count, n,
                                                         rows);
        }
    }
    FourDoubles *A = four(matrix(kSameSide)), *B = four(matrix(kOppositeSide)),
                *A_rows = four(matrix(kSameSideRows)), *B_rows = four(matrix(kOppositeSideRows));
    for (int q = 0; q < n; ++q) {
        FourDoubles *even = four(matrix(kEven)) + q * rows, *odd = four(matrix(kOdd)) + q * rows;
        for (int p = 0; p < q; ++p) {
            even[p] = four(matrix(kEven))[q + p * rows];
            odd[p] = four(matrix(kOdd))[q + p * rows];
        }
        for (int p = 0; p < n; ++p) {
            *A++ = even[p] + odd[p];
            *B++ = even[p] - odd[p];
        }
        for (int i = n; i < rows; ++i) {
            *A_rows++ = even[i] + odd[i];
            *B_rows++ = even[i] - odd[i];
        }
    }
}

void FourHalfSpaces::find_accuracies(int first, const FourProblem& problem) {
    const FourDoubles* B = four(matrix(kOppositeSide));
    FourDoubles once = {};
    for (int q = 0; q < nodes_; ++q) {
        FourDoubles at_column = {};
        for (int p = 0; p < nodes_; ++p) {
            at_column = math::larger(at_column,
                                     math::absolute(B[p + q * nodes_]) * mu_over_flux_weights_[p]);
        }
        once = math::larger(once, at_column * mu_over_flux_weights_[q]);
    }
    for (int k = 0; k < kOrders; ++k) {
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
bool FourHalfSpaces::few_sweeps_suffice() const {
    constexpr double most_sweeps = 8.0;
    for (std::size_t k = 0; k < kOrders; ++k) {
        if (once_[k] > 0.0 && !arrives_within(most_sweeps, ratio_[k], accuracy_[k] / once_[k]))
            return false;
    }
    return true;
}

void FourHalfSpaces::start_from_nothing() {
    const FourDoubles* B = four(matrix(kOppositeSide));
    FourDoubles *X = four(matrix(kX)), *psi = four(matrix(kPsi));
    for (int k = 0; k < nodes_ * nodes_; ++k) {
        psi[k] = B[k];
        X[k] = B[k] * to_nodes_.data()[k];
    }
}

// Z = F k F^T is the geometric mean of U = F k^2 F^T and V^-1 = F F^T. Arithmetic and harmonic
// means of both approach it from above and below, their eigenvectors F being the same, twice as
// many digits with each step; scaled so that the largest and the smallest k are as far off (Byers &
// Xu 2008, for one matrix). Inverses of all four are kept: rows need Z^-1 too.
bool FourHalfSpaces::start_from_means() {
    constexpr int most_steps = 12;
    const int n = nodes_, rows = nodes_ + cosines_, size = n * n;
    FourDoubles *above = four(matrix(kX)), *above_inverse = four(matrix(kGain)),
                *below = four(matrix(kPsi)), *below_inverse = four(matrix(kProduct)),
                *columns = four(matrix(kSeen));
    const FourDoubles *even = four(matrix(kEven)), *odd = four(matrix(kOdd));
    for (int q = 0; q < n; ++q) {
        for (int p = 0; p < n; ++p) {
            above[p + q * n] = -even[p + q * rows];
            below_inverse[p + q * n] = -odd[p + q * rows];
        }
        above[q + q * n] += inverse_mu_[q];
        below_inverse[q + q * n] += inverse_mu_[q];
    }
    const auto invert = [&](const FourDoubles* from, FourDoubles* to) {
        std::copy_n(from, size, to);
        math::invert_four(to, n, columns);
    };
    invert(above, above_inverse);
    invert(below_inverse, below);
    // U and V lie between (1 - q) M^-1 and (1 + q) M^-1.
    double share = 1.0, most = 0.0;
    for (std::size_t k = 0; k < kOrders; ++k) {
        most = std::max(most, ratio_[k]);
        if (once_[k] > 0.0) share = std::min(share, accuracy_[k] / once_[k]);
    }
    double lowest = std::max(1.0 - most, 1e-6), highest = inverse_mu_[0];
    for (int step = 0; step < most_steps; ++step) {
        // Both means enclose Z, and their difference is nowhere larger than on its diagonal. What
        // is left after their mean is its square.
        double apart = 0.0;
        for (int q = 0; q < n; ++q) {
            const FourDoubles here =
                (above[q + q * n] - below[q + q * n]) / (above[q + q * n] + below[q + q * n]);
            for (int k = 0; k < kOrders; ++k) apart = std::max(apart, std::abs(here[k]));
        }
        if (!(apart < 1.0 + 1e-9)) return false;  // not positive definite
        const bool is_last = step > 0 && apart * apart <= 0.1 * share;
        const double scale = is_last ? 1.0 : 1.0 / std::sqrt(lowest * highest);
        const double up = 0.5 * scale, down = 0.5 / scale;
        for (int k = 0; k < size; ++k) {
            above[k] = up * above[k] + down * below[k];
            below_inverse[k] = down * above_inverse[k] + up * below_inverse[k];
        }
        if (is_last) {
            // Z^-1 stays, and W = (I + Z)^-1 gives X = 2 W - I.
            for (int q = 0; q < n; ++q) above[q + q * n] += 1.0;
            math::invert_four(above, n, columns);
            std::copy_n(below_inverse, size, four(matrix(kOut)));
            FourDoubles *X = above, *psi = below;
            for (int k = 0; k < size; ++k) X[k] *= 2.0;
            for (int q = 0; q < n; ++q) X[q + q * n] -= 1.0;
            for (int k = 0; k < size; ++k) psi[k] = X[k] / to_nodes_.data()[k];
            once_.fill(1e300);  // no step has been made yet
            return true;
        }
        invert(above, above_inverse);
        invert(below_inverse, below);
        const double spread = std::sqrt(highest / lowest);
        lowest = 1.0;
        highest = 0.5 * (spread + 1.0 / spread);
    }
    return false;
}

// X by the fixed point of half_space.cpp.
void FourHalfSpaces::sweep_nodes() {
    const int n = nodes_, size = n * n;
    const FourDoubles *A = four(matrix(kSameSide)), *B = four(matrix(kOppositeSide));
    FourDoubles *X = four(matrix(kX)), *G = four(matrix(kGain)), *XG = four(matrix(kProduct)),
                *psi = four(matrix(kPsi));
    const double* to_nodes = to_nodes_.data();
    const Eigen::VectorXd& bounded = mu_over_flux_weights_;
    const FourDoubles ratio = four(ratio_);
    FourDoubles step = four(once_), slowest = ratio;
    for (int sweep = 0; !note_arrivals(step, slowest, accuracy_, has_arrived_); ++sweep) {
        if (sweep == kMostSweeps) return;
        for (int k = 0; k < size; ++k) G[k] = 2.0 * A[k];
        multiply<true>(B, X, G, n, n, n);
        multiply<false>(X, G, XG, n, n, n);
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
void FourHalfSpaces::sweep_rows() {
    const int n = nodes_, cosines = cosines_;
    FourDoubles *gain = four(matrix(kGain)), *seen = four(matrix(kSeen)),
                *reflected = four(matrix(kReflected));
    FourDoubles *rows = four(matrix(kRows)), *next_rows = four(matrix(kNextRows));
    std::copy_n(four(matrix(kSameSide)), n * n, gain);
    multiply<true>(four(matrix(kOppositeSide)), four(matrix(kX)), gain, n, n, n);
    std::copy_n(four(matrix(kOppositeSideRows)), cosines * n, seen);
    multiply<true>(four(matrix(kSameSideRows)), four(matrix(kX)), seen, cosines, n, n);
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
    const FourDoubles ratio = four(ratio_);
    FourDoubles step = four(once_);
    std::array<bool, kOrders> have_rows = {};
    for (int sweep = 0; !note_arrivals(step, ratio, accuracy_, have_rows); ++sweep) {
        if (sweep == kMostSweeps) break;
        std::copy_n(seen, cosines * n, next_rows);
        multiply<true>(reflected, gain, next_rows, cosines, n, n);
        step = FourDoubles{};
        for (int q = 0; q < n; ++q) {
            FourDoubles at_column = {};
            for (int i = q * cosines; i < (q + 1) * cosines; ++i)
                at_column = math::larger(at_column, math::absolute(next_rows[i] - rows[i]));
            step = math::larger(step, at_column * mu_over_flux_weights_[q]);
        }
        std::swap(rows, next_rows);
        reflect();
    }
    for (std::size_t k = 0; k < kOrders; ++k) has_arrived_[k] = has_arrived_[k] && have_rows[k];
}

// The rows of the closed form without its eigenmodes: 2 R(mu, .) D = r_mu (I + X) / 2 with
// r_mu (Z^-1 + mu V) = (E Z^-1 - O) at the cosine.
void FourHalfSpaces::solve_rows() {
    const int n = nodes_, cosines = cosines_, all = nodes_ + cosines_;
    const FourDoubles *even = four(matrix(kEven)), *odd = four(matrix(kOdd)),
                      *Z_inverse = four(matrix(kOut));
    FourDoubles *sources = four(matrix(kNextRows)), *solved = four(matrix(kRows)),
                *system = four(matrix(kGain)), *half = four(matrix(kProduct)),
                *row = four(matrix(kSeen)), *reflected = four(matrix(kReflected));
    for (int q = 0; q < n; ++q)
        for (int i = 0; i < cosines; ++i) sources[i + q * cosines] = -odd[n + i + q * all];
    math::multiply_four<true>({even + n, all}, {Z_inverse, 1, n}, sources, cosines, n, n, cosines);
    for (int i = 0; i < cosines; ++i) {
        const double mu = requested_[i];
        for (int q = 0; q < n; ++q) {
            for (int p = q; p < n; ++p)
                system[p + q * n] = Z_inverse[p + q * n] - mu * odd[p + q * all];
            system[q + q * n] += mu * inverse_mu_[q];
            row[q] = sources[i + q * cosines];
        }
        math::solve_four(system, row, n);
        for (int q = 0; q < n; ++q) solved[i + q * cosines] = mu * row[q];
    }
    const FourDoubles* X = four(matrix(kX));
    for (int k = 0; k < n * n; ++k) half[k] = 0.5 * X[k];
    for (int q = 0; q < n; ++q) half[q + q * n] += 0.5;
    multiply<false>(solved, half, reflected, cosines, n, n);
}

// 4 (mu_o + mu_i) R = T_o (A_i + T_i B)^T + A_o T_i^T with T = mu times the rows.
void FourHalfSpaces::find_pairs(const RequestedDirections& requested) {
    const int n = nodes_, cosines = cosines_;
    const int out = int(requested.out.size()), in = int(requested.in.size());
    const FourDoubles *T = four(matrix(kReflected)), *A = four(matrix(kSameSideRows));
    FourDoubles *sum = four(matrix(kSeen)), *pairs = four(matrix(kPairs));
    std::copy_n(A, cosines * n, sum);
    multiply<true>(T, four(matrix(kOppositeSide)), sum, cosines, n, n);
    gather_four(T, cosines, n, requested.out, four(matrix(kOut)));
    transpose_four(sum, cosines, n, requested.in, four(matrix(kIn)));
    multiply<false>(four(matrix(kOut)), four(matrix(kIn)), pairs, out, n, in);
    gather_four(A, cosines, n, requested.out, four(matrix(kOut)));
    transpose_four(T, cosines, n, requested.in, four(matrix(kIn)));
    multiply<true>(four(matrix(kOut)), four(matrix(kIn)), pairs, out, n, in);
    for (int i = 0; i < in; ++i) {
        for (int o = 0; o < out; ++o) {
            pairs[o + i * out] /= 4.0 * (requested.mu[requested.out[std::size_t(o)]] +
                                         requested.mu[requested.in[std::size_t(i)]]);
        }
    }
    for (std::size_t k = 0; k < std::size_t(count_); ++k) {
        Eigen::MatrixXd& multiple = multiple_[k];
        multiple.resize(out, in);
        for (int p = 0; p < out * in; ++p) multiple.data()[p] = pairs[p][k];
        has_arrived_[k] = has_arrived_[k] && multiple.allFinite();
    }
}

double FourHalfSpaces::order_zero(Reflector& reflector) const {
    const double* psi = memory_.data() + Eigen::Index(kPsi) * matrix_size_;
    const double* X = memory_.data() + Eigen::Index(kX) * matrix_size_;
    const double* T = memory_.data() + Eigen::Index(kReflected) * matrix_size_;
    reflector.nodes.resize(nodes_, nodes_);
    reflector.rows.resize(cosines_, nodes_);
    double brightness = 0.0;
    for (Eigen::Index q = 0; q < nodes_; ++q) {
        for (Eigen::Index p = 0; p < nodes_; ++p) {
            reflector.nodes(p, q) = X[(p + q * nodes_) * kOrders];
            if (p > q) continue;
            brightness =
                std::max(brightness, std::abs(psi[(p + q * nodes_) * kOrders]) *
                                         mu_over_flux_weights_[p] * mu_over_flux_weights_[q]);
        }
        for (Eigen::Index i = 0; i < cosines_; ++i)
            reflector.rows(i, q) = T[(i + q * cosines_) * kOrders] / requested_[i];
    }
    return brightness;
}

#else

bool FourHalfSpaces::solve(int, const FourProblem&, FourierModes&) { return false; }
double FourHalfSpaces::order_zero(Reflector&) const { return 0.0; }

#endif

}  // namespace miebrdf::rte
