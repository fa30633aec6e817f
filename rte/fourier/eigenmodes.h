// The eigenmodes of the radiance inside one homogeneous medium, what light each of them sends to
// the requested cosines, and the memory in which Fourier orders are solved.
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/LU>

#include "rte/fourier/fourier_mode.h"
#include "rte/math/decay_integrals.h"
#include "rte/math/matrices.h"

namespace miebrdf::rte {

/// The discrete equation of transfer in symmetric form. With i = (W M)^(1/2) I, s = i_up + i_down
/// and a = i_down - i_up it reads ds/dtau = -V a, da/dtau = -U s,
///     U = M^-1 - sum_{l-m even} alpha (2l+1) chi_l y y^T,  y = (W/M)^(1/2) Y_l^m,
///     V = M^-1 - sum_{l-m odd}  (the same).
/// Both are symmetric positive definite (U is singular for m = 0 without absorption), and
///     U = F k^2 F^T,  V^-1 = F F^T,
/// so that any function of the medium is F h(k) F^T.
///
/// For m = 0 and little absorption the slowest eigenmode (diffusion, f, k0 -> 0) comes from inverse
/// iteration with the absorption as a number of its own; the eigenproblem is solved with k0
/// moved to 1, and the other vectors are made V-orthogonal to f, so that energy is conserved to
/// rounding whatever the eigensolver left behind. F has then n + 1 columns, one of them (nearly)
/// zero.
struct Eigenmodes {
    Eigen::MatrixXd vectors;  ///< F, n x K with K = n or n + 1
    Eigen::VectorXd rates;    ///< k >= 0, K
    Eigen::MatrixXd even;     ///< U, n x n
    Eigen::MatrixXd odd;      ///< V, n x n
    bool physical = false;    ///< U and V are positive definite: the truncation fits the grid
};

/// sum_l a_l y_l y_l^T over the degrees of one parity of l - m, n x n: U = M^-1 - even and
/// V = M^-1 - odd; and sum_l a_l Y_l(mu) y_l^T, requested x n: what scatters into the requested
/// cosines out of s = i_up + i_down (even) and a = i_down - i_up (odd).
struct ScatteringKernels {
    Eigen::MatrixXd even, odd;
    Eigen::MatrixXd even_rows, odd_rows;
};

/// The slowest eigenmode where little is absorbed, the smallest eigenpair of U g = k0^2 V^-1 g. Of
/// one medium after the other in the same memory.
class DiffusionEigenmode {
  public:
    void find(const Eigen::MatrixXd& U, const Eigen::MatrixXd& V, const FourierMode& mode,
              const FourierMedium& medium, const ZenithGrid& grid);

    const Eigen::VectorXd& vector() const { return f_; }  ///< V^-1 g, normalised to f^T V f = 1
    double rate_squared() const { return rate_squared_; }

  private:
    Eigen::LLT<Eigen::MatrixXd> V_;
    Eigen::LDLT<Eigen::MatrixXd> U_;
    Eigen::VectorXd g0_, d_, g_, f_, Ud_, beta_, moments_;
    double rate_squared_ = 0.0;
};

/// The rows of ScatteringKernels out of the eigenmodes, requested x K: even F^-T = even V F, and
/// odd F.
struct EigenmodeSources {
    Eigen::MatrixXd even, odd;
};

/// Finds the eigenmodes of one Fourier order after the other in the same memory.
class EigenmodeSolver {
  public:
    /// @param tolerance  of X: orders above 0 are left as the eigensolver finds them when that is
    ///                   ten times better
    const Eigenmodes& find(const FourierMode& mode, const FourierMedium& medium,
                           const ZenithGrid& grid, double tolerance);

    /// The two steps of it.
    const ScatteringKernels& form_kernels(const FourierMode& mode, const FourierMedium& medium);
    const Eigenmodes& find_from_kernels(const FourierMode& mode, const FourierMedium& medium,
                                        const ZenithGrid& grid, double tolerance);

    const Eigenmodes& eigenmodes() const { return eigenmodes_; }
    const ScatteringKernels& kernels() const { return kernels_; }
    void find_sources(EigenmodeSources& sources);

    /// F diag(h) F^T for values h_j = h(k_j); `result` is resized to n x n.
    template <typename Values>
    void function(const Eigen::ArrayBase<Values>& values, Eigen::MatrixXd& result) {
        scaled_ = eigenmodes_.vectors * values.matrix().asDiagonal();
        result.resize(scaled_.rows(), scaled_.rows());
        result.noalias() = scaled_ * eigenmodes_.vectors.transpose();
    }

  private:
    double refine();
    double find_correction();
    void append_diffusion();

    Eigenmodes eigenmodes_;
    ScatteringKernels kernels_;
    Eigen::MatrixXd scaled_;
    Eigen::MatrixXd U_, L_, C_, product_, VF_, R_, S_;
    DiffusionEigenmode diffusion_;
    Eigen::VectorXd Vf_;
    Eigen::RowVectorXd overlaps_;
    math::SymmetricEigen eigen_;
};

/// Intermediate results of solve_half_space, solve_layer and put_on. One is enough for all media
/// of a stack, all Fourier orders and one number of nodes after the other: what it holds matters
/// only to the function that runs. Not thread-safe.
struct FourierWork {
    EigenmodeSolver eigenmode_solver;
    EigenmodeSources sources;
    PairProducts products;
    math::DecayIntegrator decays;                       ///< of the layer solved last
    Eigen::VectorXd alternating;                        ///< strengths with the sign of their column
    Eigen::MatrixXd moments;                            ///< cosines x degrees
    Eigen::MatrixXd beam, through, incoming, down, up;  ///< nodes x cosines
    Eigen::MatrixXd pairs;
    Eigen::MatrixXd first_out, first_in;  ///< FourierMode::at_requested of both lists
    Eigen::VectorXd flux_weights, mu_over_flux_weights, inverse_mu;
    Eigen::VectorXd near, far;
    Eigen::VectorXd tanh_rates, sinh_rates;
    Eigen::VectorXd between, incident, downward, upward;  ///< one answer of a layer on a base
    Eigen::MatrixXd square, other_square, below, joint;   ///< n x n
    Eigen::MatrixXd same_side, opposite_side, gain, product, to_nodes;        ///< n x n
    Eigen::MatrixXd rows, seen, mirrored;                                     ///< cosines x n
    Eigen::MatrixXd same_side_rows, opposite_side_rows, other_rows, to_rows;  ///< cosines x n
    Eigen::MatrixXd reflected_out, reflected_in, scattered_out, scattered_in;
    /// Largest 4 (mu + mu') |R| between nodes of the half-space solved last.
    double brightness = 0.0;
    bool is_swept = false;  ///< that half-space: by the fixed point, without eigenmodes
    Eigen::PartialPivLU<Eigen::MatrixXd> bounces;
};

}  // namespace miebrdf::rte
