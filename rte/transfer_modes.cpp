#include "rte/transfer_modes.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <cmath>

namespace miebrdf::rte {
namespace {

// Below this the diffusion mode is so slow that squaring it in the eigenproblem costs digits
// (docs/numerics.md).
constexpr double deflate_below = 1e-3;

struct DiffusionMode {
    Eigen::VectorXd vector;  ///< f, normalised to f^T V f = 1
    double rate_squared = 0.0;
};

// Smallest eigenpair of U g = k0^2 V^-1 g. Without absorption it is known: U g0 = 0 for
// g0 = (W M)^(1/2) 1. With a little, inverse iteration from there; k0^2 from the Rayleigh quotient
// written so that nothing cancels: with U = Uc + (1 - alpha) sum beta y y^T and g = g0 + d,
//     g^T U g = d^T Uc d + (1 - alpha) sum beta (y.g)^2.
DiffusionMode find_diffusion_mode(const Eigen::MatrixXd& U, const Eigen::LLT<Eigen::MatrixXd>& V,
                                  const PhaseMode& mode,
                                  const Eigen::Ref<const Eigen::VectorXd>& strengths,
                                  double one_minus_albedo, const ZenithGrid& grid) {
    const Eigen::VectorXd g0 = (grid.weights.array() * grid.mu.array()).sqrt();
    Eigen::VectorXd d = Eigen::VectorXd::Zero(g0.size());
    if (one_minus_albedo > 0.0) {
        const Eigen::LDLT<Eigen::MatrixXd> U_factor(U);
        Eigen::VectorXd g = g0;
        for (int step = 0; step < 12; ++step) {
            g = U_factor.solve(V.solve(g));
            g *= g0.squaredNorm() / g0.dot(g);
            const double change = (g - g0 - d).norm();
            d = g - g0;
            if (change <= 1e-15 * g0.norm()) break;
        }
    }
    const Eigen::VectorXd g = g0 + d;
    const Eigen::VectorXd f = V.solve(g);
    const double norm = g.dot(f);
    const auto even = even_columns(mode.scaled_nodes);
    const Eigen::ArrayXd beta = even_part(strengths).array() / (1.0 - one_minus_albedo);
    const double absorbed_d = (beta * (even.transpose() * d).array().square()).sum();
    const double absorbed_g = (beta * (even.transpose() * g).array().square()).sum();
    const double quotient = d.dot(U * d) + one_minus_albedo * (absorbed_g - absorbed_d);
    return {f / std::sqrt(norm), std::max(0.0, quotient / norm)};
}

// One step of iterative refinement (Ogita & Aishima 2018, for a pencil): with R = I - F^T V F and
// S = (V F)^T U (V F), the vectors become F (I + E), E_ij = (S_ij + lambda_j R_ij) /
// (lambda_j - lambda_i). Householder reduction mixes rows of very different size (1/mu^2 spans 14
// decades on a fine mapped grid) and leaves 1e-12 to 1e-8 in the slow modes; this takes them back
// to rounding for a few matrix products (docs/numerics.md).
// Returns the largest correction; its square is the error that is left.
double refine_modes(const Eigen::MatrixXd& U, const Eigen::MatrixXd& V, Eigen::MatrixXd& F,
                    Eigen::VectorXd& rates_squared) {
    const Eigen::Index n = F.rows();
    const Eigen::MatrixXd VF = V * F;
    Eigen::MatrixXd R = -F.transpose() * VF;
    R.diagonal().array() += 1.0;
    const Eigen::MatrixXd S = VF.transpose() * (U * VF);
    for (Eigen::Index i = 0; i < n; ++i) rates_squared[i] = S(i, i) / (1.0 - R(i, i));
    Eigen::MatrixXd E = 0.5 * R;
    for (Eigen::Index j = 0; j < n; ++j) {
        for (Eigen::Index i = 0; i < n; ++i) {
            const double rotation = S(i, j) + rates_squared[j] * R(i, j);
            const double gap = rates_squared[j] - rates_squared[i];
            // Rates closer than their coupling need no rotation: any function is the same for both.
            if (i != j && std::abs(rotation) < 1e-3 * std::abs(gap)) E(i, j) = rotation / gap;
        }
    }
    F += F * E;
    return E.cwiseAbs().maxCoeff();
}

}  // namespace

Eigen::MatrixXd TransferModes::function(const Eigen::Ref<const Eigen::ArrayXd>& values) const {
    return vectors * values.matrix().asDiagonal() * vectors.transpose();
}

TransferModes decompose(const PhaseMode& mode, const Eigen::Ref<const Eigen::VectorXd>& strengths,
                        double one_minus_albedo, const ZenithGrid& grid) {
    const Eigen::Index n = grid.size();
    TransferModes modes;
    const auto even = even_columns(mode.scaled_nodes);
    const auto odd = odd_columns(mode.scaled_nodes);
    modes.even.noalias() = -even * even_part(strengths).asDiagonal() * even.transpose();
    modes.odd.noalias() = -odd * odd_part(strengths).asDiagonal() * odd.transpose();
    modes.even.diagonal() += grid.mu.cwiseInverse();
    modes.odd.diagonal() += grid.mu.cwiseInverse();

    const Eigen::LLT<Eigen::MatrixXd> V_factor(modes.odd);
    if (V_factor.info() != Eigen::Success) return modes;
    const bool deflate = mode.order == 0 && one_minus_albedo < deflate_below;
    Eigen::MatrixXd U = modes.even;
    DiffusionMode diffusion;
    if (deflate) {
        diffusion = find_diffusion_mode(U, V_factor, mode, strengths, one_minus_albedo, grid);
        U += (1.0 - diffusion.rate_squared) * diffusion.vector * diffusion.vector.transpose();
    }

    // U = F k^2 F^T and V^-1 = F F^T: with V = L L^T, L^T U L = Q k^2 Q^T, F = L^-T Q.
    const Eigen::MatrixXd L = V_factor.matrixL();
    const Eigen::MatrixXd C = L.transpose() * U * L;
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(C);
    if (eigen.info() != Eigen::Success || !(eigen.eigenvalues()[0] > 0.0)) return modes;

    modes.vectors = V_factor.matrixU().solve(eigen.eigenvectors());
    modes.rates = eigen.eigenvalues();
    for (int step = 0; step < 4; ++step) {
        if (refine_modes(U, modes.odd, modes.vectors, modes.rates) <= 1e-8) break;
    }
    modes.rates = modes.rates.cwiseMax(0.0).cwiseSqrt();
    if (deflate) {
        const Eigen::RowVectorXd overlaps =
            (modes.odd * diffusion.vector).transpose() * modes.vectors;
        modes.vectors -= diffusion.vector * overlaps;
        modes.vectors.conservativeResize(Eigen::NoChange, n + 1);
        modes.vectors.col(n) = diffusion.vector;
        modes.rates.conservativeResize(n + 1);
        modes.rates[n] = std::sqrt(diffusion.rate_squared);
    }
    modes.physical = true;
    return modes;
}

}  // namespace miebrdf::rte
