#include "rte/half_space.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "rte/mode_sources.h"
#include "rte/transfer_modes.h"

namespace miebrdf::rte {
namespace {

// R(mu_p, mu_q) = sum_l (-1)^(l-m) a_l phi_l(p) phi_l(q) / (4 (mu_p + mu_q)) at the nodes: the
// right side of eq. (3), factorised.
void apply_equation_at_nodes(const ScatteringMode& medium, const PhaseMode& mode,
                             const ZenithGrid& grid, Eigen::MatrixXd& X) {
    const Eigen::VectorXd D = flux_weights(grid);
    const Eigen::MatrixXd rows = D.cwiseInverse().asDiagonal() * X;
    const Eigen::MatrixXd phi = mode.at_nodes + reflected_moments(grid.mu, rows, mode);
    X.noalias() = phi * alternating(medium.strengths).asDiagonal() * phi.transpose();
    for (Eigen::Index q = 0; q < X.cols(); ++q) {
        for (Eigen::Index p = 0; p <= q; ++p) {
            X(p, q) *= 0.5 * D[p] * D[q] / (grid.mu[p] + grid.mu[q]);
            X(q, p) = X(p, q);  // reciprocity, exactly
        }
    }
}

// The same without its first term (Y Y), at the requested pairs.
void fill_multiple(const ScatteringMode& medium, const PhaseMode& mode,
                   const RequestedDirections& requested, Reflector& result) {
    const Eigen::MatrixXd extra = reflected_moments(requested.mu, result.rows, mode);
    const Eigen::VectorXd strengths = alternating(medium.strengths);
    const Eigen::MatrixXd Y_in = mode.at_requested(requested.in, Eigen::all);
    const Eigen::MatrixXd extra_in = extra(requested.in, Eigen::all);
    const Eigen::MatrixXd Y_out = mode.at_requested(requested.out, Eigen::all);
    const Eigen::MatrixXd extra_out = extra(requested.out, Eigen::all);
    result.multiple = Y_out * strengths.asDiagonal() * extra_in.transpose() +
                      extra_out * strengths.asDiagonal() * (Y_in + extra_in).transpose();
    for (Eigen::Index i = 0; i < result.multiple.cols(); ++i) {
        for (Eigen::Index o = 0; o < result.multiple.rows(); ++o) {
            result.multiple(o, i) /=
                4.0 * (requested.mu[requested.out[o]] + requested.mu[requested.in[i]]);
        }
    }
}

// Upward radiance at mu from the source function integrated to infinite depth. Each eigenmode
// decays as exp(-k tau), so its integral is 1 / (1 + mu k).
void fill_rows_from_modes(const TransferModes& modes, const ScatteringMode& medium,
                          const PhaseMode& mode, const RequestedDirections& requested,
                          Reflector& result) {
    const auto [even, odd] = mode_sources(medium, mode, modes);
    Eigen::MatrixXd weights = even - odd * modes.rates.asDiagonal();
    for (Eigen::Index j = 0; j < weights.cols(); ++j) {
        weights.col(j).array() *= 0.5 / (1.0 + modes.rates[j] * requested.mu.array());
    }
    result.rows = weights * modes.vectors.transpose();
    result.rows += result.rows * result.nodes;  // s = (I + X) i_down at the surface
}

// The row of Ambartsumian's equation at each cosine, for any X that satisfies it at the nodes:
// r (I + mu (P - Q X)) = [(E - O) + (E + O) X] / 2, P = (U + V) / 2, Q = (V - U) / 2.
void fill_rows_by_solving(const ScatteringMode& medium, const PhaseMode& mode,
                          const ZenithGrid& grid, const RequestedDirections& requested,
                          Reflector& result) {
    const Eigen::Index n = grid.size();
    const auto [even, odd] = phase_rows(medium, mode);
    const Eigen::MatrixXd sources = 0.5 * ((even - odd) + (even + odd) * result.nodes);
    const Eigen::MatrixXd same_side =
        mode.scaled_nodes * (0.5 * medium.strengths).asDiagonal() * mode.scaled_nodes.transpose();
    const Eigen::MatrixXd opposite_side = mode.scaled_nodes *
                                          (0.5 * alternating(medium.strengths)).asDiagonal() *
                                          mode.scaled_nodes.transpose();
    Eigen::MatrixXd propagator = -same_side - opposite_side * result.nodes;
    propagator.diagonal() += grid.mu.cwiseInverse();
    result.rows.resize(requested.mu.size(), n);
    for (Eigen::Index r = 0; r < requested.mu.size(); ++r) {
        const Eigen::MatrixXd system =
            Eigen::MatrixXd::Identity(n, n) + requested.mu[r] * propagator.transpose();
        result.rows.row(r) = system.partialPivLu().solve(sources.row(r).transpose()).transpose();
    }
}

}  // namespace

Reflector solve_half_space(HalfSpaceMethod method, const ScatteringMode& medium,
                           const PhaseMode& mode, const ZenithGrid& grid,
                           const RequestedDirections& requested, double tolerance) {
    const Eigen::Index n = grid.size();
    Reflector result;
    if (method == HalfSpaceMethod::automatic && few_sweeps_suffice(medium, tolerance)) {
        result = sweep_half_space(medium, mode, grid, requested, tolerance);
        result.iterations = 0;
        if (!result.physical) return result;
    } else if (method == HalfSpaceMethod::automatic) {
        const TransferModes modes =
            decompose(mode, medium.strengths, medium.one_minus_albedo, grid);
        if (!modes.physical) return result;
        Eigen::MatrixXd impedance = modes.function(modes.rates.array());
        impedance.diagonal().array() += 1.0;
        const Eigen::LLT<Eigen::MatrixXd> factor(impedance);
        if (factor.info() != Eigen::Success) return result;
        result.nodes = factor.solve(2.0 * Eigen::MatrixXd::Identity(n, n));
        result.nodes.diagonal().array() -= 1.0;
        apply_equation_at_nodes(medium, mode, grid, result.nodes);
        fill_rows_from_modes(modes, medium, mode, requested, result);
        result.physical = true;
    } else {
        result = method == HalfSpaceMethod::fixed_point
                     ? iterate_half_space(medium, mode, grid, tolerance)
                     : double_to_half_space(medium, mode, grid, tolerance);
        if (!result.physical) return result;
        fill_rows_by_solving(medium, mode, grid, requested, result);
    }
    fill_multiple(medium, mode, requested, result);
    return result;
}

}  // namespace miebrdf::rte
