#include "rte/transfer_modes.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "rte/math/positive_definite.h"

namespace miebrdf::rte {
namespace {

// Below this the diffusion mode is so slow that squaring it in the eigenproblem costs digits
// (docs/numerics.md).
constexpr double deflate_below = 1e-3;

struct DiffusionMode {
    Eigen::VectorXd vector;  ///< f, normalised to f^T V f = 1
    double rate_squared = 0.0;
};

// What the eigensolver alone leaves in X of an order above 0 (measured: Rayleigh, HG 0.75 and 0.99,
// albedo 0.5 to 1, optical depth 0.01 to 100, 16 to 256 nodes; docs/numerics.md). Order 0 has slow
// modes that amplify it, and must conserve energy.
double left_by_eigensolver(Eigen::Index nodes) { return 2e-17 * std::pow(double(nodes), 4); }

// Smallest eigenpair of U g = k0^2 V^-1 g. Without absorption it is known: U g0 = 0 for
// g0 = (W M)^(1/2) 1. With a little, inverse iteration from there; k0^2 from the Rayleigh quotient
// written so that nothing cancels: with U = Uc + (1 - alpha) sum beta y y^T and g = g0 + d,
//     g^T U g = d^T Uc d + (1 - alpha) sum beta (y.g)^2.
DiffusionMode find_diffusion_mode(const Eigen::MatrixXd& U, const Eigen::MatrixXd& V_matrix,
                                  const PhaseMode& mode,
                                  const Eigen::Ref<const Eigen::VectorXd>& strengths,
                                  double one_minus_albedo, const ZenithGrid& grid) {
    const Eigen::LLT<Eigen::MatrixXd> V(V_matrix);
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

}  // namespace

void ModeDecomposition::form_matrices(const PhaseMode& mode,
                                      const Eigen::Ref<const Eigen::VectorXd>& strengths,
                                      const ZenithGrid& grid) {
    const Eigen::Index n = grid.size();
    const auto form = [&](const auto& degrees, const auto& weights, Eigen::MatrixXd& result) {
        scaled_ = degrees * weights.asDiagonal();
        result.resize(n, n);
        result.noalias() = -scaled_ * degrees.transpose();
        result.diagonal() += grid.mu.cwiseInverse();
    };
    form(even_columns(mode.scaled_nodes), even_part(strengths), modes_.even);
    form(odd_columns(mode.scaled_nodes), odd_part(strengths), modes_.odd);
}

// One step of iterative refinement (Ogita & Aishima 2018, for a pencil): with R = I - F^T V F and
// S = (V F)^T U (V F), the vectors become F (I + E), E_ij = (S_ij + lambda_j R_ij) /
// (lambda_j - lambda_i). Householder reduction mixes rows of very different size (1/mu^2 spans 14
// decades on a fine mapped grid) and leaves 1e-12 to 1e-8 in the slow modes; this takes them back
// to rounding for a few matrix products (docs/numerics.md).
// Returns the largest correction; its square is the error that is left.
double ModeDecomposition::refine() {
    Eigen::MatrixXd& F = modes_.vectors;
    Eigen::VectorXd& rates_squared = modes_.rates;
    const Eigen::Index n = F.rows();
    VF_.noalias() = modes_.odd * F;
    R_.noalias() = -F.transpose() * VF_;
    R_.diagonal().array() += 1.0;
    product_.noalias() = U_ * VF_;
    S_.noalias() = VF_.transpose() * product_;
    for (Eigen::Index i = 0; i < n; ++i) rates_squared[i] = S_(i, i) / (1.0 - R_(i, i));
    double largest = 0.0;
    for (Eigen::Index j = 0; j < n; ++j) {
        for (Eigen::Index i = 0; i < n; ++i) {  // R becomes E
            const double rotation = S_(i, j) + rates_squared[j] * R_(i, j);
            const double gap = rates_squared[j] - rates_squared[i];
            // Rates closer than their coupling need no rotation: any function is the same for both.
            const bool rotates = i != j && std::abs(rotation) < 1e-3 * std::abs(gap);
            R_(i, j) = rotates ? rotation / gap : 0.5 * R_(i, j);
            largest = std::max(largest, std::abs(R_(i, j)));
        }
    }
    product_.noalias() = F * R_;
    F += product_;
    return largest;
}

void ModeDecomposition::append(const Eigen::VectorXd& vector, double rate_squared) {
    const Eigen::Index n = vector.size();
    const Eigen::RowVectorXd overlaps = (modes_.odd * vector).transpose() * modes_.vectors;
    modes_.vectors -= vector * overlaps;
    modes_.vectors.conservativeResize(Eigen::NoChange, n + 1);
    modes_.vectors.col(n) = vector;
    modes_.rates.conservativeResize(n + 1);
    modes_.rates[n] = std::sqrt(rate_squared);
}

const TransferModes& ModeDecomposition::find(const PhaseMode& mode,
                                             const Eigen::Ref<const Eigen::VectorXd>& strengths,
                                             double one_minus_albedo, const ZenithGrid& grid,
                                             double tolerance) {
    const Eigen::Index n = grid.size();
    modes_.physical = false;
    form_matrices(mode, strengths, grid);
    L_ = modes_.odd;
    const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> V_factor(L_);
    if (V_factor.info() != Eigen::Success) return modes_;
    L_.triangularView<Eigen::StrictlyUpper>().setZero();
    const bool deflate = mode.order == 0 && one_minus_albedo < deflate_below;
    U_ = modes_.even;
    DiffusionMode diffusion;
    if (deflate) {
        diffusion = find_diffusion_mode(U_, modes_.odd, mode, strengths, one_minus_albedo, grid);
        U_ += (1.0 - diffusion.rate_squared) * diffusion.vector * diffusion.vector.transpose();
    }

    // U = F k^2 F^T and V^-1 = F F^T: with V = L L^T, L^T U L = Q k^2 Q^T, F = L^-T Q.
    for (Eigen::MatrixXd* square : {&product_, &C_, &VF_, &R_, &S_}) square->resize(n, n);
    product_.noalias() = U_ * L_;
    C_.noalias() = L_.transpose() * product_;
    eigen_.compute(C_);
    if (eigen_.info() != Eigen::Success || !(eigen_.eigenvalues()[0] > 0.0)) return modes_;

    math::invert_lower(L_);
    modes_.vectors.resize(n, n);
    modes_.vectors.noalias() = L_.transpose() * eigen_.eigenvectors();
    modes_.rates = eigen_.eigenvalues();
    const bool is_good_enough = mode.order > 0 && left_by_eigensolver(n) <= 0.1 * tolerance;
    const int steps = is_good_enough ? 0 : 4;
    for (int step = 0; step < steps; ++step) {
        if (refine() <= 1e-8) break;
    }
    modes_.rates = modes_.rates.cwiseMax(0.0).cwiseSqrt();
    if (deflate) append(diffusion.vector, diffusion.rate_squared);
    modes_.physical = true;
    return modes_;
}

}  // namespace miebrdf::rte
