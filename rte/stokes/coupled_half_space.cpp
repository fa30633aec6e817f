#include "rte/stokes/coupled.h"

#include <algorithm>

#include "rte/math/matrices.h"
#include "rte/math/tolerance_budget.h"

namespace miebrdf::rte {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// Where row r of the linear components and row p of V are among all rows.
struct Places {
    Eigen::Index linear;  ///< linear components of a node
    Eigen::Index of_linear(Eigen::Index r) const { return r / linear * (linear + 1) + r % linear; }
    Eigen::Index of_circular(Eigen::Index p) const { return p * (linear + 1) + linear; }
};

struct Split {
    MatrixXd linear, circular;
};

// Rows of a table that belong to linear components and to V.
Split split_rows(const Eigen::Ref<const MatrixXd>& table, const Places& places) {
    const Eigen::Index nodes = table.rows() / (places.linear + 1);
    Split split{MatrixXd(nodes * places.linear, table.cols()), MatrixXd(nodes, table.cols())};
    for (Eigen::Index r = 0; r < split.linear.rows(); ++r)
        split.linear.row(r) = table.row(places.of_linear(r));
    for (Eigen::Index p = 0; p < nodes; ++p)
        split.circular.row(p) = table.row(places.of_circular(p));
    return split;
}

// Upward radiance at requested cosines out of the field on top: 1/2 (E F^-T - O F Z^) (I + mu A)^-1
// F^T (I + X) with A = CoupledModes::rates. A is nearly diagonal: (I + mu A)^-1 by iteration from
// its diagonal, for all cosines together.
bool fill_rows(const FourierMode& mode, const FourierMedium& medium, const VectorXd& mu,
               int rows_per_node, const CoupledModes& modes, double tolerance, MatrixXd& rows,
               const MatrixXd& X) {
    const CoupledSources sources = sources_of(mode, medium, modes, rows_per_node);
    const MatrixXd G = 0.5 * (sources.even - sources.odd);
    MatrixXd rest = modes.rates;
    const VectorXd diagonal = rest.diagonal();
    rest.diagonal().setZero();
    const Eigen::ArrayXXd inverse = (1.0 + (mu * diagonal.transpose()).array()).inverse();
    MatrixXd solution = G.array() * inverse, next;
    constexpr int most_steps = 200;
    const double goal = std::max(1e-15, kIterationShare * tolerance);
    double change = 1.0;
    for (int step = 0; step < most_steps && change > goal && G.rows() > 0; ++step) {
        next.noalias() = solution * rest;
        next = (G.array() - (mu.asDiagonal() * next).array()) * inverse;
        const double largest = next.cwiseAbs().maxCoeff();
        change = largest > 0.0 ? (next - solution).cwiseAbs().maxCoeff() / largest : 0.0;
        solution.swap(next);
    }
    const MatrixXd field = sources_at_nodes(modes, solution, rows_per_node);
    rows = field;
    rows.noalias() += field * X;
    return change <= goal || G.rows() == 0;
}

// (mu + mu') X J = sum of strength phi phi^T at the nodes: removes the rounding at grazing nodes.
void apply_equation(const FourierMode& mode, const ZenithGrid& grid, const VectorXd& J,
                    CoupledWork& work, MatrixXd& X) {
    const VectorXd D = flux_weights(grid);
    reflected_moments(grid.mu.cwiseQuotient(D), X, mode, work.fourier.moments);
    work.fourier.moments += mode.at_nodes;
    const MatrixXd square = (work.fourier.moments * work.fourier.alternating.asDiagonal()) *
                            work.fourier.moments.transpose();
    for (Eigen::Index q = 0; q < X.cols(); ++q) {
        X.col(q) =
            0.5 * J[q] * D[q] * D.array() * square.col(q).array() / (grid.mu.array() + grid.mu[q]);
    }
}

}  // namespace

VectorXd metric(Eigen::Index rows, int rows_per_node) {
    VectorXd J = VectorXd::Ones(rows);
    for (Eigen::Index r = rows_per_node - 1; r < rows; r += rows_per_node) J[r] = -1.0;
    return J;
}

CoupledSources sources_of(const FourierMode& mode, const FourierMedium& medium,
                          const CoupledModes& modes, int rows_per_node) {
    const Places places{rows_per_node - 1};
    const Eigen::Index k = modes.S.rows(), n = modes.rates.rows();
    const auto source = [&](const auto& at_requested, const auto& strengths, const auto& at_nodes,
                            const MatrixXd& of_linear, const MatrixXd& of_circular) {
        const Split y = split_rows(MatrixXd(at_nodes), places);
        const MatrixXd weighted = at_requested * strengths.asDiagonal();
        MatrixXd result(weighted.rows(), n);
        result.leftCols(k).noalias() = weighted * (y.linear.transpose() * of_linear);
        result.rightCols(n - k).noalias() = weighted * (-(y.circular.transpose() * of_circular));
        return result;
    };
    CoupledSources sources{
        source(even_columns(mode.at_requested), even_part(medium.strengths),
               even_columns(mode.scaled_nodes), modes.inverse_linear, modes.inverse_circular),
        {}};
    const MatrixXd odd =
        source(odd_columns(mode.at_requested), odd_part(medium.strengths),
               odd_columns(mode.scaled_nodes), modes.linear().vectors, modes.circular().vectors);
    sources.odd.resize(odd.rows(), n);
    sources.odd.leftCols(k) =
        odd.leftCols(k) * modes.S - odd.rightCols(n - k) * modes.K.transpose();
    sources.odd.rightCols(n - k) = odd.leftCols(k) * modes.K + odd.rightCols(n - k) * modes.T;
    return sources;
}

MatrixXd sources_at_nodes(const CoupledModes& modes, const MatrixXd& rows, int rows_per_node) {
    const Places places{rows_per_node - 1};
    const Eigen::Index k = modes.S.rows(), n = modes.rates.rows();
    const MatrixXd linear = rows.leftCols(k) * modes.linear().vectors.transpose();
    const MatrixXd circular = rows.rightCols(n - k) * modes.circular().vectors.transpose();
    MatrixXd result(rows.rows(), linear.cols() + circular.cols());
    for (Eigen::Index r = 0; r < linear.cols(); ++r)
        result.col(places.of_linear(r)) = linear.col(r);
    for (Eigen::Index p = 0; p < circular.cols(); ++p)
        result.col(places.of_circular(p)) = circular.col(p);
    return result;
}

MatrixXd joined(const MatrixXd& linear, const MatrixXd& mixed, const MatrixXd& circular,
                int rows_per_node) {
    const Places places{rows_per_node - 1};
    const Eigen::Index n = linear.rows() + circular.rows();
    MatrixXd X(n, n);
    for (Eigen::Index j = 0; j < linear.cols(); ++j)
        for (Eigen::Index i = 0; i < linear.rows(); ++i)
            X(places.of_linear(i), places.of_linear(j)) = linear(i, j);
    for (Eigen::Index j = 0; j < circular.cols(); ++j) {
        for (Eigen::Index i = 0; i < linear.rows(); ++i) {
            X(places.of_linear(i), places.of_circular(j)) = mixed(i, j);
            X(places.of_circular(j), places.of_linear(i)) = -mixed(i, j);
        }
        for (Eigen::Index i = 0; i < circular.rows(); ++i)
            X(places.of_circular(i), places.of_circular(j)) = circular(i, j);
    }
    return X;
}

// [[A, B], [-B^T, C]]^-1 with A = I + Z_l, C = I + Z_c positive definite: so is the complement
// C + B^T A^-1 B.
bool reflection_of(const MatrixXd& Z_linear, const MatrixXd& Z_mixed, const MatrixXd& Z_circular,
                   int rows_per_node, MatrixXd& X) {
    MatrixXd A = Z_linear, inverse_A, E, G;
    A.diagonal().array() += 1.0;
    if (!math::invert_positive_definite(A, inverse_A)) return false;
    G.noalias() = inverse_A * Z_mixed;
    MatrixXd complement = Z_circular;
    complement.noalias() += Z_mixed.transpose() * G;
    complement.diagonal().array() += 1.0;
    complement = (0.5 * (complement + complement.transpose())).eval();
    if (!math::invert_positive_definite(complement, E)) return false;
    const MatrixXd mixed = G * E;
    MatrixXd linear = inverse_A;
    linear.noalias() -= mixed * G.transpose();
    X = joined(2.0 * linear, -2.0 * mixed, 2.0 * E, rows_per_node);
    X.diagonal().array() -= 1.0;
    return true;
}

void solve_coupled_half_space(const StokesTables& tables, const StokesBlock& block,
                              const MatrixStrengths& strengths, const FourierMode& mode,
                              const FourierMedium& medium, const ZenithGrid& nodes,
                              const RequestedDirections& cosines, const ZenithGrid& grid,
                              const RequestedDirections& requested, double tolerance,
                              CoupledWork& work, Reflector& result) {
    result.specular.resize(0);
    result.has_transmittance = false;
    result.iterations = 0;
    result.residual = 0.0;
    result.converged = true;
    CoupledModes& modes = work.modes;
    result.physical =
        modes.find(tables, block, strengths, medium.one_minus_albedo, nodes, cosines, tolerance);
    if (!result.physical) return;
    const int c = int(block.size());
    const MatrixXd& F = modes.linear().vectors;
    const MatrixXd& G = modes.circular().vectors;
    result.physical = reflection_of(F * modes.S * F.transpose(), F * modes.K * G.transpose(),
                                    G * modes.T * G.transpose(), c, result.nodes);
    if (!result.physical) return;
    alternating(medium.strengths, work.fourier.alternating);
    const VectorXd J = metric(grid.size(), c);
    apply_equation(mode, grid, J, work, result.nodes);
    result.physical =
        fill_rows(mode, medium, requested.mu, c, modes, tolerance, result.rows, result.nodes);
    result.iterations = modes.steps;
    reflected_moments(requested.mu, result.rows, mode, work.fourier.moments);
    result.multiple.setZero(Eigen::Index(requested.out.size()), Eigen::Index(requested.in.size()));
    gather_rows(mode.at_requested, requested.out, work.fourier.first_out);
    gather_rows(mode.at_requested, requested.in, work.fourier.first_in);
    work.fourier.products.add(work.fourier.alternating, work.fourier.moments,
                              work.fourier.first_out, work.fourier.first_in, requested,
                              result.multiple);
    divide_by_cosines(requested, result.multiple);
    result.multiple *= metric(result.multiple.cols(), c).asDiagonal();
}

}  // namespace miebrdf::rte
