#include "rte/layer/layers_side_by_side.h"

#include <algorithm>
#include <cmath>

#include "rte/half_space/pairs_side_by_side.h"
#include "rte/math/matrices_side_by_side.h"

namespace miebrdf::rte {

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
    kSameSideRows,
    kOppositeSideRows,
    kM,  // of M, and of P^-1
    kMRows,
    kPInverse,
    kPInverseRows,
    kOpposite,  // the inverses of both
    kOppositeRows,
    kOther,
    kOtherRows,
    kColumns,  // two of them
    kBeam,
    kOut,
    kIn,
    kResults,  // two: nodes, moved rows, pairs
    kPlaces = kResults + 6
};
// Where M and P are no longer needed:
constexpr Place kTransmission = kM, kTransmissionRows = kMRows, kBelow = kPInverse, kSum = kEven,
                kDown = kPInverseRows, kUp = kOdd, kSeen = kOther;

// How often a thin layer is to be doubled. The start errs by x^5/45 of x = k h/2 in artanh: after J
// means by y^5 16^-J/45 of y = k tau/2, which changes tanh y by 0.06 16^-J at most. Of what decays
// fast, k h/2 beyond 1, it has 3/x in place of a tanh of 1, which is 1 to 2 exp(-6 4^J/y) after J:
// of beams to the tolerance, of grazing nodes, whose weight is small, to its fourth root.
int doublings(double depth, double least_node, double least_cosine, double tolerance) {
    const double smooth = std::log(0.06 / tolerance) / std::log(16.0);
    const double exponent = std::log(2.0 / tolerance);
    const double fastest = std::max(1.0 / least_cosine, 0.25 / least_node);
    const double steep = std::log(exponent * fastest * depth / 12.0) / std::log(4.0);
    return int(std::ceil(std::max({smooth, steep, 0.0})));
}

template <typename Doubles>
Eigen::VectorXd first_of(const Doubles* matrix, const Eigen::VectorXd& vector) {
    Eigen::VectorXd result = Eigen::VectorXd::Zero(vector.size());
    add_first_order(matrix, vector, result);
    return result;
}

}  // namespace

template <typename Doubles>
Doubles* LayersSideBySide::matrix(std::size_t which) {
    static_assert(EIGEN_MAX_ALIGN_BYTES >= sizeof(Doubles), "vectors of Eigen's hold registers");
    return reinterpret_cast<Doubles*>(memory_.data() + Eigen::Index(which) * matrix_size_);
}

template <typename Doubles>
ReflectorSideBySide<Doubles> LayersSideBySide::reflector() {
    const std::size_t first = kResults + 3 * std::size_t(slot_);
    return {matrix<Doubles>(first), matrix<Doubles>(first + 1), matrix<Doubles>(first + 2)};
}

template <typename Doubles>
void LayersSideBySide::allocate(const RequestedDirections& requested) {
    const auto most = Eigen::Index(std::max(
        {requested.out.size(), requested.in.size(), std::size_t(cosines_), std::size_t(nodes_)}));
    const Eigen::Index n = nodes_;
    const auto size = std::max({n * n, cosines_ * n, most * most}) * lanes_;
    // What lies below may be in this memory.
    if (size == matrix_size_) return;
    matrix_size_ = size;
    if (memory_.size() < Eigen::Index(kPlaces) * matrix_size_)
        memory_.resize(Eigen::Index(kPlaces) * matrix_size_);
}

// Of nodes, and of rows below them with `diagonal_` for cosines.
template <typename Doubles>
void LayersSideBySide::invert(const Doubles* nodes, const Doubles* rows, Doubles* inverse,
                              Doubles* inverse_rows) {
    const int n = nodes_, cosines = cosines_;
    std::copy_n(nodes, n * n, inverse);
    math::invert_each(inverse, n, matrix<Doubles>(kColumns));
    multiply_each<false>(rows, inverse, inverse_rows, cosines, n, n);
    for (int q = 0; q < n; ++q)
        for (int i = 0; i < cosines; ++i) inverse_rows[i + q * cosines] *= -1.0 / diagonal_[i];
}

template <typename Doubles>
void LayersSideBySide::start_thin(double depth) {
    const int n = nodes_, cosines = cosines_, all = nodes_ + cosines_;
    Doubles *U = matrix<Doubles>(kOpposite), *U_rows = matrix<Doubles>(kOppositeRows);
    Doubles *V = matrix<Doubles>(kOther), *V_rows = matrix<Doubles>(kOtherRows);
    const Doubles *even = matrix<Doubles>(kEven), *odd = matrix<Doubles>(kOdd);
    for (int q = 0; q < n; ++q, even += all, odd += all) {
        for (int p = 0; p < n; ++p) {
            U[p + q * n] = -even[p];
            V[p + q * n] = -odd[p];
        }
        U[q + q * n] += inverse_mu_[q];
        V[q + q * n] += inverse_mu_[q];
        for (int i = 0; i < cosines; ++i) {
            U_rows[i + q * cosines] = even[n + i] * (-1.0 / mu_[i]);
            V_rows[i + q * cosines] = odd[n + i] * (-1.0 / mu_[i]);
        }
    }
    diagonal_ = mu_.cwiseInverse();
    Doubles *M = matrix<Doubles>(kM), *M_rows = matrix<Doubles>(kMRows);
    Doubles *P = matrix<Doubles>(kPInverse), *P_rows = matrix<Doubles>(kPInverseRows);
    invert(V, V_rows, M, M_rows);
    invert(U, U_rows, P, P_rows);
    const double inverse = 2.0 / depth, direct = depth / 6.0;
    for (int k = 0; k < n * n; ++k) {
        M[k] = inverse * M[k] + direct * U[k];
        P[k] = inverse * P[k] + direct * V[k];
    }
    for (int k = 0; k < cosines * n; ++k) {
        M_rows[k] = inverse * M_rows[k] + direct * U_rows[k];
        P_rows[k] = inverse * P_rows[k] + direct * V_rows[k];
    }
    diagonal_ = inverse * mu_ + direct * mu_.cwiseInverse();
}

template <typename Doubles>
void LayersSideBySide::take_means() {
    const int n = nodes_, cosines = cosines_;
    Doubles *M = matrix<Doubles>(kM), *M_rows = matrix<Doubles>(kMRows);
    Doubles *P = matrix<Doubles>(kPInverse), *P_rows = matrix<Doubles>(kPInverseRows);
    Doubles *M_inverse = matrix<Doubles>(kOpposite),
            *M_inverse_rows = matrix<Doubles>(kOppositeRows);
    Doubles *P_inverse = matrix<Doubles>(kOther), *P_inverse_rows = matrix<Doubles>(kOtherRows);
    invert(M, M_rows, M_inverse, M_inverse_rows);
    invert(P, P_rows, P_inverse, P_inverse_rows);
    for (int k = 0; k < n * n; ++k) {
        M[k] = 0.5 * (M[k] + P_inverse[k]);
        P[k] = 0.5 * (P[k] + M_inverse[k]);
    }
    for (int k = 0; k < cosines * n; ++k) {
        M_rows[k] = 0.5 * (M_rows[k] + P_inverse_rows[k]);
        P_rows[k] = 0.5 * (P_rows[k] + M_inverse_rows[k]);
    }
    diagonal_ = 0.5 * (diagonal_ + diagonal_.cwiseInverse());
}

// R and T of the layer alone out of (I + M)^-1 and (I + P)^-1 = I - (I + P^-1)^-1, and where these
// are not between 0 and 1 no physical solution.
template <typename Doubles>
void LayersSideBySide::find_layer() {
    const int n = nodes_, cosines = cosines_;
    Doubles *M = matrix<Doubles>(kM), *P = matrix<Doubles>(kPInverse);
    Doubles *opposite = matrix<Doubles>(kOpposite), *opposite_rows = matrix<Doubles>(kOppositeRows);
    Doubles *other = matrix<Doubles>(kOther), *other_rows = matrix<Doubles>(kOtherRows);
    for (int q = 0; q < n; ++q) {
        M[q + q * n] += 1.0;
        P[q + q * n] += 1.0;
    }
    diagonal_.array() += 1.0;
    invert(M, matrix<Doubles>(kMRows), opposite, opposite_rows);
    invert(P, matrix<Doubles>(kPInverseRows), other, other_rows);
    Doubles *T = matrix<Doubles>(kTransmission), *T_rows = matrix<Doubles>(kTransmissionRows);
    for (int k = 0; k < lanes_; ++k) {
        bool is_physical = true;
        for (int q = 0; q < n; ++q) {
            const double one = opposite[q + q * n][k], two = other[q + q * n][k];
            is_physical = is_physical && one >= 0.0 && one <= 1.0 && two >= 0.0 && two <= 1.0;
        }
        physical_[std::size_t(k)] = is_physical;
    }
    for (int k = 0; k < n * n; ++k) {
        T[k] = -(opposite[k] + other[k]);
        opposite[k] -= other[k];
    }
    for (int q = 0; q < n; ++q) T[q + q * n] += 1.0;
    for (int k = 0; k < cosines * n; ++k) {
        T_rows[k] = -(opposite_rows[k] + other_rows[k]);
        opposite_rows[k] -= other_rows[k];
    }
}

// 4 (mu_o + mu_i) R = T_o (A_i + T_i B)^T + A_o T_i^T - S_o (d_i B_i + S_i B)^T - d_o B_o S_i^T
// with T and S mu times the rows of reflected and of transmitted light, d the direct beam.
template <typename Doubles>
void LayersSideBySide::find_pairs(const RequestedDirections& requested) {
    const int n = nodes_, cosines = cosines_;
    const Doubles* B = matrix<Doubles>(kOppositeSide);
    const Doubles *A_rows = matrix<Doubles>(kSameSideRows),
                  *B_rows = matrix<Doubles>(kOppositeSideRows);
    const Doubles *reflected = matrix<Doubles>(kOppositeRows),
                  *transmitted = matrix<Doubles>(kTransmissionRows);
    Doubles *moved = matrix<Doubles>(kBeam), *sum = matrix<Doubles>(kSum),
            *back = matrix<Doubles>(kUp), *pairs = reflector<Doubles>().pairs;
    const auto add = [&](const Doubles* of_out, const Doubles* of_in) {
        multiply_pairs<true>(of_out, of_in, n, requested, matrix<Doubles>(kOut),
                             matrix<Doubles>(kIn), pairs);
    };
    std::fill_n(pairs, requested.out.size() * requested.in.size(), Doubles{});
    const auto move = [&](const Doubles* rows, double sign, Doubles* to) {
        for (int q = 0; q < n; ++q)
            for (int i = 0; i < cosines; ++i)
                to[i + q * cosines] = rows[i + q * cosines] * (sign * mu_[i]);
    };
    move(reflected, 1.0, moved);
    std::copy_n(A_rows, cosines * n, sum);
    multiply_each<true>(moved, B, sum, cosines, n, n);
    add(moved, sum);
    add(A_rows, moved);
    move(transmitted, -1.0, moved);  // the sign of the whole
    for (int q = 0; q < n; ++q)
        for (int i = 0; i < cosines; ++i)
            back[i + q * cosines] = B_rows[i + q * cosines] * direct_[i];
    add(back, moved);
    multiply_each<false>(moved, B, sum, cosines, n, n);
    for (int k = 0; k < cosines * n; ++k) sum[k] = back[k] - sum[k];
    add(moved, sum);
    divide_by_cosines(requested, pairs);
}

// Light between layer and base: with Z = 2 (I + X)^-1 - I of both, s = up + down and
// down - up = Z_b s - (I + Z_b) b = -Z_c s + (I + Z_c) t of the beams b and t that the base and the
// layer send there, s (Z_b + Z_c) = b (I + Z_b) + t (I + Z_c) in rows, and down = (s - b)(I +
// Z_b)/2.
template <typename Doubles>
void LayersSideBySide::meet(const ReflectorSideBySide<Doubles>& below) {
    const int n = nodes_, cosines = cosines_;
    Doubles *of_base = matrix<Doubles>(kBelow), *of_layer = matrix<Doubles>(kSameSide),
            *joint = matrix<Doubles>(kSeen);
    const auto invert_with_one = [&](const Doubles* X, Doubles* inverse) {
        for (int k = 0; k < n * n; ++k) inverse[k] = 0.5 * X[k];
        for (int q = 0; q < n; ++q) inverse[q + q * n] += 0.5;
        math::invert_each(inverse, n, matrix<Doubles>(kColumns));
    };
    invert_with_one(below.nodes, of_base);
    invert_with_one(matrix<Doubles>(kOpposite), of_layer);
    for (int k = 0; k < n * n; ++k) joint[k] = of_base[k] + of_layer[k];
    for (int q = 0; q < n; ++q) joint[q + q * n] -= 2.0;
    math::invert_each(joint, n, matrix<Doubles>(kColumns));
    Doubles *beam = matrix<Doubles>(kBeam), *both = matrix<Doubles>(kSum);
    for (int q = 0; q < n; ++q)
        for (int i = 0; i < cosines; ++i)
            beam[i + q * cosines] = below.moved_rows[i + q * cosines] * (direct_[i] / mu_[i]);
    multiply_each<false>(beam, of_base, both, cosines, n, n);
    multiply_each<true>(matrix<Doubles>(kTransmissionRows), of_layer, both, cosines, n, n);
    Doubles *down = matrix<Doubles>(kDown), *up = matrix<Doubles>(kUp);
    multiply_each<false>(both, joint, up, cosines, n, n);
    for (int k = 0; k < cosines * n; ++k) both[k] = 0.5 * (up[k] - beam[k]);
    multiply_each<false>(both, of_base, down, cosines, n, n);
    for (int k = 0; k < cosines * n; ++k) up[k] -= down[k];
}

template <typename Doubles>
void LayersSideBySide::add_pairs(const ReflectorSideBySide<Doubles>& below,
                                 const RequestedDirections& requested) {
    const int n = nodes_, cosines = cosines_;
    const int out = int(requested.out.size()), in = int(requested.in.size());
    Doubles *down = matrix<Doubles>(kDown), *up = matrix<Doubles>(kUp),
            *half = matrix<Doubles>(kSum);
    Doubles* pairs = reflector<Doubles>().pairs;
    const auto add = [&](const Doubles* rows, const Doubles* lit) {
        for (int k = 0; k < cosines * n; ++k) half[k] = 0.5 * rows[k];
        multiply_pairs<true>(half, lit, n, requested, matrix<Doubles>(kOut), matrix<Doubles>(kIn),
                             pairs);
    };
    add(matrix<Doubles>(kBeam), down);
    add(matrix<Doubles>(kTransmissionRows), up);
    for (int i = 0; i < in; ++i) {
        for (int o = 0; o < out; ++o) {
            pairs[o + i * out] +=
                below.pairs[o + i * out] *
                (direct_[requested.out[std::size_t(o)]] * direct_[requested.in[std::size_t(i)]]);
        }
    }
}

// X + T up of light from the nodes: the same with t = T and no beam from below; and the rows.
template <typename Doubles>
void LayersSideBySide::add_rows() {
    const int n = nodes_, cosines = cosines_;
    const Doubles *T = matrix<Doubles>(kTransmission), *R_rows = matrix<Doubles>(kOppositeRows);
    const ReflectorSideBySide<Doubles> result = reflector<Doubles>();
    Doubles *rows = result.moved_rows, *X = result.nodes;
    std::copy_n(R_rows, cosines * n, rows);
    multiply_each<true>(matrix<Doubles>(kUp), T, rows, cosines, n, n);
    for (int q = 0; q < n; ++q)
        for (int i = 0; i < cosines; ++i) rows[i + q * cosines] *= mu_[i];
    Doubles *through = matrix<Doubles>(kOut), *sum = matrix<Doubles>(kIn),
            *up = matrix<Doubles>(kEven);
    multiply_each<false>(matrix<Doubles>(kSameSide), T, through, n, n, n);
    multiply_each<false>(matrix<Doubles>(kSeen), through, sum, n, n, n);
    multiply_each<false>(matrix<Doubles>(kBelow), sum, up, n, n, n);
    for (int k = 0; k < n * n; ++k) up[k] = sum[k] - 0.5 * up[k];
    std::copy_n(matrix<Doubles>(kOpposite), n * n, X);
    multiply_each<true>(T, up, X, n, n, n);
}

// As `meet`, with t = T sky and no beam from below.
template <typename Doubles>
void LayersSideBySide::reflect_sky(const Eigen::VectorXd& sky,
                                   const ReflectorSideBySide<Doubles>* below,
                                   Eigen::VectorXd& at_nodes, Eigen::VectorXd& at_requested) {
    at_nodes.setZero(nodes_);
    at_requested.setZero(cosines_);
    if (below != nullptr) {
        const Eigen::VectorXd through = first_of(matrix<Doubles>(kTransmission), sky);
        const Eigen::VectorXd both =
            first_of(matrix<Doubles>(kSeen), first_of(matrix<Doubles>(kSameSide), through));
        const Eigen::VectorXd down = 0.5 * first_of(matrix<Doubles>(kBelow), both);
        const Eigen::VectorXd up = both - down;
        add_first_order(below->moved_rows, down, at_requested);
        at_requested.array() *= direct_.array() / mu_.array();
        add_first_order(matrix<Doubles>(kTransmissionRows), up, at_requested);
        add_first_order(matrix<Doubles>(kTransmission), up, at_nodes);
    }
    add_first_order(matrix<Doubles>(kOppositeRows), sky, at_requested);
    add_first_order(matrix<Doubles>(kOpposite), sky, at_nodes);
}

template <typename Doubles>
bool LayersSideBySide::put_on(int first, const ProblemSideBySide& problem, double depth,
                              const ReflectorSideBySide<Doubles>* below, bool is_top) {
    const RequestedDirections& requested = problem.requested;
    mu_ = requested.mu;
    inverse_mu_ = problem.grid.mu.cwiseInverse();
    nodes_ = int(inverse_mu_.size());
    cosines_ = int(mu_.size());
    lanes_ = kLanes<Doubles>;
    const double least_cosine = cosines_ > 0 ? mu_.minCoeff() : 1.0;
    const int steps = doublings(depth, problem.grid.mu.minCoeff(), least_cosine, problem.tolerance);
    constexpr int most_steps = 12;
    if (steps > most_steps) return false;
    if (first == 0 && problem.one_minus_albedo < HalfSpacesSideBySide::kLeastAbsorption)
        return false;
    allocate<Doubles>(requested);
    slot_ = 1 - slot_;
    direct_ = (-depth * mu_.cwiseInverse().array()).exp();
    problem.kernels.set(problem.grid, mu_, int(problem.strengths.size()));
    problem.kernels.form(first, problem.strengths, requested, problem.modes, matrix<Doubles>(kEven),
                         matrix<Doubles>(kOdd), matrix<Doubles>(kM));
    problem.kernels.form_sides(matrix<Doubles>(kEven), matrix<Doubles>(kOdd),
                               matrix<Doubles>(kSameSide), matrix<Doubles>(kOppositeSide),
                               matrix<Doubles>(kSameSideRows), matrix<Doubles>(kOppositeSideRows));
    start_thin<Doubles>(std::ldexp(depth, -steps));
    for (int step = 0; step < steps; ++step) take_means<Doubles>();
    find_layer<Doubles>();
    find_pairs<Doubles>(requested);
    if (below != nullptr) {
        meet(*below);
        add_pairs(*below, requested);
        if (!is_top) add_rows<Doubles>();
    } else if (!is_top) {
        const ReflectorSideBySide<Doubles> result = reflector<Doubles>();
        std::copy_n(matrix<Doubles>(kOpposite), nodes_ * nodes_, result.nodes);
        Doubles* rows = result.moved_rows;
        const Doubles* R_rows = matrix<Doubles>(kOppositeRows);
        for (int q = 0; q < nodes_; ++q)
            for (int i = 0; i < cosines_; ++i)
                rows[i + q * cosines_] = R_rows[i + q * cosines_] * mu_[i];
    }
    return true;
}

template ReflectorSideBySide<math::FourDoubles> LayersSideBySide::reflector();
template bool LayersSideBySide::put_on(int, const ProblemSideBySide&, double,
                                       const ReflectorSideBySide<math::FourDoubles>*, bool);
template void LayersSideBySide::reflect_sky(const Eigen::VectorXd&,
                                            const ReflectorSideBySide<math::FourDoubles>*,
                                            Eigen::VectorXd&, Eigen::VectorXd&);
#ifdef MIEBRDF_HAS_EIGHT_DOUBLES
template ReflectorSideBySide<math::EightDoubles> LayersSideBySide::reflector();
template bool LayersSideBySide::put_on(int, const ProblemSideBySide&, double,
                                       const ReflectorSideBySide<math::EightDoubles>*, bool);
template void LayersSideBySide::reflect_sky(const Eigen::VectorXd&,
                                            const ReflectorSideBySide<math::EightDoubles>*,
                                            Eigen::VectorXd&, Eigen::VectorXd&);
#endif

#endif

}  // namespace miebrdf::rte
