#include "rte/fourier/eigenmodes.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "rte/math/tolerance_budget.h"

namespace miebrdf::rte {
namespace {

// Below this absorption the diffusion mode is so slow that squaring it in the eigenproblem costs
// digits (docs/numerics.md).
constexpr double kDeflateBelow = 1e-3;

// A step of refinement rotates eigenmodes by no more than this, and the last one by no more than
// the root of rounding: its square is the error that is left.
constexpr double kSteepest = 1e-3, kRefined = 1e-8;

// The eigensolver alone leaves so much in X of an order above 0 (measured: Rayleigh, HG 0.75 and
// 0.99, albedo 0.5 to 1, optical depth 0.01 to 100, 16 to 256 nodes; docs/numerics.md). Order 0 has
// slow eigenmodes that amplify it, and must conserve energy.
double left_by_eigensolver(Eigen::Index nodes) { return 2e-17 * std::pow(double(nodes), 4); }

}  // namespace

// Without absorption it is known: U g0 = 0 for g0 = (W M)^(1/2) 1. With a little, inverse iteration
// from there; k0^2 from the Rayleigh quotient written so that nothing cancels: with U = Uc + (1 -
// alpha) sum beta y y^T and g = g0 + d,
//     g^T U g = d^T Uc d + (1 - alpha) sum beta (y.g)^2.
void DiffusionEigenmode::find(const Eigen::MatrixXd& U, const Eigen::MatrixXd& V,
                              const FourierMode& mode, const FourierMedium& medium,
                              const ZenithGrid& grid) {
    const double one_minus_albedo = medium.one_minus_albedo;
    V_.compute(V);
    g0_ = (grid.weights.array() * grid.mu.array()).sqrt();
    mode.keep_intensity(g0_);
    d_.setZero(g0_.size());
    if (one_minus_albedo > 0.0) {
        U_.compute(U);
        g_ = g0_;
        for (int step = 0; step < 12; ++step) {
            f_ = V_.solve(g_);
            g_ = U_.solve(f_);
            g_ *= g0_.squaredNorm() / g0_.dot(g_);
            const double change = (g_ - g0_ - d_).norm();
            d_ = g_ - g0_;
            if (change <= 1e-15 * g0_.norm()) break;
        }
    }
    g_ = g0_ + d_;
    f_ = V_.solve(g_);
    const double norm = g_.dot(f_);
    const auto even = even_columns(mode.scaled_nodes);
    beta_ = even_part(medium.strengths) / (1.0 - one_minus_albedo);
    const auto absorbed = [&](const Eigen::VectorXd& radiance) {
        moments_.noalias() = even.transpose() * radiance;
        return (beta_.array() * moments_.array().square()).sum();
    };
    const double absorbed_d = absorbed(d_), absorbed_g = absorbed(g_);
    Ud_.noalias() = U * d_;
    const double quotient = d_.dot(Ud_) + one_minus_albedo * (absorbed_g - absorbed_d);
    f_ /= std::sqrt(norm);
    rate_squared_ = std::max(0.0, quotient / norm);
}

const ScatteringKernels& EigenmodeSolver::form_kernels(const FourierMode& mode,
                                                       const FourierMedium& medium) {
    const Eigen::Index n = mode.scaled_nodes.rows();
    const auto form = [&](const auto& degrees, const auto& at_requested, const auto& weights,
                          Eigen::MatrixXd& kernel, Eigen::MatrixXd& rows) {
        scaled_ = degrees * weights.asDiagonal();
        kernel.resize(n, n);
        kernel.noalias() = scaled_ * degrees.transpose();
        rows.resize(at_requested.rows(), n);
        rows.noalias() = at_requested * scaled_.transpose();
    };
    form(even_columns(mode.scaled_nodes), even_columns(mode.at_requested),
         even_part(medium.strengths), kernels_.even, kernels_.even_rows);
    form(odd_columns(mode.scaled_nodes), odd_columns(mode.at_requested), odd_part(medium.strengths),
         kernels_.odd, kernels_.odd_rows);
    return kernels_;
}

// One step of iterative refinement (Ogita & Aishima 2018, for a pencil): with R = I - F^T V F and
// S = (V F)^T U (V F), the vectors become F (I + E), E_ij = (S_ij + lambda_j R_ij) /
// (lambda_j - lambda_i). Householder reduction mixes rows of very different size (1/mu^2 spans 14
// decades on a fine mapped grid) and leaves 1e-12 to 1e-8 in the slow eigenmodes; this takes them
// back to rounding for a few matrix products (docs/numerics.md). Returns the largest correction;
// its square is the error that is left.
double EigenmodeSolver::refine() {
    Eigen::MatrixXd& F = eigenmodes_.vectors;
    VF_.noalias() = eigenmodes_.odd * F;
    R_.noalias() = -F.transpose() * VF_;
    R_.diagonal().array() += 1.0;
    const double largest = find_correction();
    product_.noalias() = F * R_;
    F += product_;
    return largest;
}

// From R and V F: the rates, and E in place of R. Returns the largest element of E.
// Rates closer than a thousand times their coupling are rotated by no first-order step: any
// function is nearly the same for both.
double EigenmodeSolver::find_correction() {
    Eigen::VectorXd& rates_squared = eigenmodes_.rates;
    const Eigen::Index n = R_.rows();
    product_.noalias() = U_ * VF_;
    S_.noalias() = VF_.transpose() * product_;
    for (Eigen::Index i = 0; i < n; ++i) rates_squared[i] = S_(i, i) / (1.0 - R_(i, i));
    double largest = 0.0;
    for (Eigen::Index j = 0; j < n; ++j) {
        auto E = R_.col(j).array();
        const auto rotation = S_.col(j).array() + rates_squared[j] * E;
        const auto gap = rates_squared[j] - rates_squared.array();
        E = (rotation.abs() < kSteepest * gap.abs()).select(rotation / gap, 0.5 * E);
        largest = std::max(largest, E.abs().maxCoeff());
    }
    return largest;
}

// The others become V-orthogonal to it.
void EigenmodeSolver::append_diffusion() {
    const Eigen::VectorXd& f = diffusion_.vector();
    Vf_.noalias() = eigenmodes_.odd * f;
    overlaps_.noalias() = Vf_.transpose() * eigenmodes_.vectors;
    product_.noalias() = f * overlaps_;
    eigenmodes_.vectors -= product_;
    const Eigen::Index count = eigenmodes_.rates.size();
    eigenmodes_.vectors.conservativeResize(Eigen::NoChange, count + 1);
    eigenmodes_.vectors.col(count) = f;
    eigenmodes_.rates.conservativeResize(count + 1);
    eigenmodes_.rates[count] = std::sqrt(diffusion_.rate_squared());
}

const Eigenmodes& EigenmodeSolver::find(const FourierMode& mode, const FourierMedium& medium,
                                        const ZenithGrid& grid, double tolerance) {
    form_kernels(mode, medium);
    return find_from_kernels(mode, medium, grid, tolerance);
}

const Eigenmodes& EigenmodeSolver::find_from_kernels(const FourierMode& mode,
                                                     const FourierMedium& medium,
                                                     const ZenithGrid& grid, double tolerance) {
    const Eigen::Index n = grid.size();
    eigenmodes_.physical = false;
    eigenmodes_.even = -kernels_.even;
    eigenmodes_.even.diagonal() += grid.mu.cwiseInverse();
    eigenmodes_.odd = -kernels_.odd;
    eigenmodes_.odd.diagonal() += grid.mu.cwiseInverse();
    L_ = eigenmodes_.odd;
    const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> V_factor(L_);
    if (V_factor.info() != Eigen::Success) return eigenmodes_;
    L_.triangularView<Eigen::StrictlyUpper>().setZero();
    const bool deflate =
        mode.fourier_order == 0 && mode.has_intensity() && medium.one_minus_albedo < kDeflateBelow;
    U_ = eigenmodes_.even;
    for (Eigen::MatrixXd* square : {&product_, &C_, &VF_, &R_, &S_}) square->resize(n, n);
    if (deflate) {
        diffusion_.find(U_, eigenmodes_.odd, mode, medium, grid);
        Vf_ = (1.0 - diffusion_.rate_squared()) * diffusion_.vector();
        product_.noalias() = Vf_ * diffusion_.vector().transpose();
        U_ += product_;
    }

    // U = F k^2 F^T and V^-1 = F F^T: with V = L L^T, L^T U L = Q k^2 Q^T, F = L^-T Q.
    product_.noalias() = U_ * L_;
    C_.noalias() = L_.transpose() * product_;
    if (!eigen_.compute(C_) || !(eigen_.values()[0] > 0.0)) return eigenmodes_;

    math::invert_lower(L_);
    eigenmodes_.vectors.resize(n, n);
    eigenmodes_.vectors.noalias() = L_.transpose() * eigen_.vectors();
    eigenmodes_.rates = eigen_.values();
    const bool is_good_enough =
        mode.fourier_order > 0 &&
        left_by_eigensolver(n / mode.rows_per_node) <= kIterationShare * tolerance;
    const int steps = is_good_enough ? 0 : 4;
    for (int step = 0; step < steps; ++step) {
        if (refine() <= kRefined) break;
    }
    eigenmodes_.rates = eigenmodes_.rates.cwiseMax(0.0).cwiseSqrt();
    if (deflate) append_diffusion();
    eigenmodes_.physical = true;
    return eigenmodes_;
}

void EigenmodeSolver::find_sources(EigenmodeSources& sources) {
    const Eigen::Index cosines = kernels_.even_rows.rows(), modes = eigenmodes_.vectors.cols();
    scaled_.resize(cosines, eigenmodes_.vectors.rows());
    scaled_.noalias() = kernels_.even_rows * eigenmodes_.odd;  // F^-T = V F
    sources.even.resize(cosines, modes);
    sources.even.noalias() = scaled_ * eigenmodes_.vectors;
    sources.odd.resize(cosines, modes);
    sources.odd.noalias() = kernels_.odd_rows * eigenmodes_.vectors;
}

}  // namespace miebrdf::rte
