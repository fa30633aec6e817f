// The iterative half-space methods: the paper's, doubling, which shares nothing with the closed
// form but the equation.
#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <cmath>

#include "rte/fourier/eigenmodes.h"
#include "rte/half_space/half_space.h"
#include "rte/math/interruption.h"
#include "rte/math/tolerance_budget.h"

namespace miebrdf::rte {
namespace {

constexpr int kMostFixedPointSteps = 20000;
constexpr int kMostDoublings = 60;  // a conservative medium halves its error with each

}  // namespace

Reflector iterate_half_space(const FourierMedium& medium, const FourierMode& mode,
                             const ZenithGrid& grid, double tolerance) {
    // Eq. (3) factorises: (mu_p + mu_q) R_pq = 1/4 sum_l (-1)^(l-m) a_l phi_l(p) phi_l(q),
    // phi_l = Y_l + 2 (-1)^(l-m) mu R W Y_l. Starting from phi = Y is single scattering.
    const Eigen::VectorXd D = flux_weights(grid);
    const Eigen::VectorXd strengths = alternating(medium.strengths);
    Eigen::MatrixXd phi = mode.at_nodes;
    Eigen::MatrixXd next(grid.size(), grid.size());
    Eigen::MatrixXd previous = Eigen::MatrixXd::Zero(grid.size(), grid.size());

    Reflector result;
    result.nodes.resize(grid.size(), grid.size());
    result.converged = false;
    double last_change = 0.0;
    while (result.iterations < kMostFixedPointSteps) {
        math::interruption_point();
        ++result.iterations;
        next.noalias() = phi * strengths.asDiagonal() * phi.transpose();
        // Judged on (mu + mu') R, which stays bounded: R grows like 1/mu at grazing angles and
        // would hide errors everywhere else.
        const double scale = next.cwiseAbs().maxCoeff();
        const double change = scale > 0.0 ? (next - previous).cwiseAbs().maxCoeff() / scale : 0.0;
        for (Eigen::Index q = 0; q < grid.size(); ++q) {
            result.nodes.col(q) =
                0.5 * D[q] * next.col(q).array() * D.array() / (grid.mu.array() + grid.mu[q]);
        }
        // Steps that shrink by the factor `ratio` still have change * ratio / (1 - ratio) to go:
        // when it is close to 1, a small step proves nothing.
        const double ratio = last_change > 0.0 ? change / last_change : 0.0;
        result.residual = change;
        if (change == 0.0 ||
            (ratio < 1.0 && change * ratio <= tolerance * (1.0 - ratio) && result.iterations > 2)) {
            result.converged = true;
            break;
        }
        last_change = change;
        previous.swap(next);
        phi = mode.at_nodes +
              reflected_moments(grid.mu, D.cwiseInverse().asDiagonal() * result.nodes, mode);
    }
    result.physical = result.nodes.allFinite();
    return result;
}

Reflector double_to_half_space(const FourierMedium& medium, const FourierMode& mode,
                               const ZenithGrid& grid, double tolerance) {
    const Eigen::Index n = grid.size();
    const auto even = even_columns(mode.scaled_nodes);
    const auto odd = odd_columns(mode.scaled_nodes);
    Eigen::MatrixXd U = -even * even_part(medium.strengths).asDiagonal() * even.transpose();
    Eigen::MatrixXd V = -odd * odd_part(medium.strengths).asDiagonal() * odd.transpose();
    U.diagonal() += grid.mu.cwiseInverse();
    V.diagonal() += grid.mu.cwiseInverse();

    // A layer of optical depth 2 / gamma by the implicit midpoint rule. It has the same invariant
    // subspace as the medium, so doubling it converges to the exact X for any gamma between the
    // smallest and the largest rate; their geometric mean balances both ends.
    const Eigen::MatrixXd identity = Eigen::MatrixXd::Identity(n, n);
    const double gamma = std::sqrt(1.0 / (grid.mu[0] * grid.mu[n - 1]));
    const Eigen::LLT<Eigen::MatrixXd> even_factor(gamma * identity + U);
    const Eigen::LLT<Eigen::MatrixXd> odd_factor(gamma * identity + V);
    Reflector result;
    result.converged = false;
    if (even_factor.info() != Eigen::Success || odd_factor.info() != Eigen::Success) return result;
    const Eigen::MatrixXd even_part_of_layer = even_factor.solve(gamma * identity);
    const Eigen::MatrixXd odd_part_of_layer = odd_factor.solve(gamma * identity);
    Eigen::MatrixXd X = even_part_of_layer - odd_part_of_layer;
    Eigen::MatrixXd T = even_part_of_layer + odd_part_of_layer - identity;

    const Eigen::VectorXd to_bounded =  // X to (mu + mu') R, apart from the sum
        flux_weights(grid).cwiseInverse();
    while (result.iterations < kMostDoublings) {
        math::interruption_point();
        ++result.iterations;
        const Eigen::PartialPivLU<Eigen::MatrixXd> bounces(identity - X * X);
        const Eigen::MatrixXd once = bounces.solve(T);
        Eigen::MatrixXd change = T * (X * once);
        T = T * once;
        X += change;
        double largest = 0.0;
        double scale = 0.0;
        for (Eigen::Index q = 0; q < n; ++q) {
            for (Eigen::Index p = 0; p < n; ++p) {
                const double factor = (grid.mu[p] + grid.mu[q]) * to_bounded[p] * to_bounded[q];
                largest = std::max(largest, std::abs(change(p, q)) * factor);
                scale = std::max(scale, std::abs(X(p, q)) * factor);
            }
        }
        result.residual = scale > 0.0 ? largest / scale : 0.0;
        result.converged = has_converged(result.residual, tolerance);
        if (result.converged) break;
    }
    result.nodes = 0.5 * (X + X.transpose());
    result.physical = result.nodes.allFinite();
    return result;
}

}  // namespace miebrdf::rte
