#include "rte/half_space/half_space.h"

#include <Eigen/LU>

#include "rte/fourier/eigenmodes.h"
#include "rte/math/matrices.h"

namespace miebrdf::rte {

Eigen::VectorXd flux_weights(const ZenithGrid& grid) {
    return (grid.weights.array() * grid.mu.array()).sqrt();
}

void reflected_moments(const Eigen::Ref<const Eigen::VectorXd>& mu,
                       const Eigen::Ref<const Eigen::MatrixXd>& rows, const FourierMode& mode,
                       math::ScratchMatrix& moments) {
    // 2 R W Y = (2 R D) (W/M)^(1/2) Y.
    moments.resize(rows.rows(), mode.scaled_nodes.cols());
    moments.noalias() = rows * mode.scaled_nodes;
    for (Eigen::Index c = 0; c < moments.cols(); ++c) {
        if (c % 2 == 0) {
            moments.col(c).array() *= mu.array();
        } else {
            moments.col(c).array() *= -mu.array();
        }
    }
}

math::ScratchMatrix reflected_moments(const Eigen::Ref<const Eigen::VectorXd>& mu,
                                      const Eigen::Ref<const Eigen::MatrixXd>& rows,
                                      const FourierMode& mode) {
    math::ScratchMatrix moments;
    reflected_moments(mu, rows, mode, moments);
    return moments;
}

void no_reflection(const ZenithGrid& grid, const RequestedDirections& requested, Reflector& none) {
    none.nodes.setZero(grid.size(), grid.size());
    none.rows.setZero(requested.mu.size(), grid.size());
    none.multiple.setZero(Eigen::Index(requested.out.size()), Eigen::Index(requested.in.size()));
    none.specular.resize(0);
    none.iterations = 0;
    none.residual = 0.0;
    none.converged = none.physical = true;
}

void mirror_ground(const Eigen::VectorXd& at_nodes, const Eigen::VectorXd& at_requested,
                   const RequestedDirections& requested, Reflector& mirror) {
    mirror.nodes = at_nodes.asDiagonal();
    mirror.rows.setZero(at_requested.size(), at_nodes.size());
    mirror.multiple.setZero(Eigen::Index(requested.out.size()), Eigen::Index(requested.in.size()));
    mirror.specular = at_requested;
    mirror.iterations = 0;
    mirror.residual = 0.0;
    mirror.converged = mirror.physical = true;
}

void lambertian_ground(double albedo, const FourierMode& mode, const ZenithGrid& grid,
                       const RequestedDirections& requested, Reflector& ground) {
    no_reflection(grid, requested, ground);
    if (mode.fourier_order > 0 || !mode.has_intensity()) return;
    Eigen::VectorXd D = flux_weights(grid);
    mode.keep_intensity(D);
    // A rule that does not integrate mu exactly must still return the fraction `albedo` of the
    // flux.
    const double reflection = albedo * 0.5 / D.squaredNorm();
    ground.nodes = 2.0 * reflection * D * D.transpose();
    Eigen::VectorXd one = Eigen::VectorXd::Ones(requested.mu.size());
    mode.keep_intensity(one);
    ground.rows = 2.0 * reflection * one * D.transpose();
    for (Eigen::Index i = 0; i < ground.multiple.cols(); ++i) {
        for (Eigen::Index o = 0; o < ground.multiple.rows(); ++o) {
            ground.multiple(o, i) =
                albedo * one[requested.out[std::size_t(o)]] * one[requested.in[std::size_t(i)]];
        }
    }
}

namespace {

// R(mu_p, mu_q) = sum_l (-1)^(l-m) a_l phi_l(p) phi_l(q) / (4 (mu_p + mu_q)) at the nodes: the
// right side of eq. (3), factorised.
void apply_equation_at_nodes(const FourierMode& mode, const ZenithGrid& grid, FourierWork& work,
                             Eigen::MatrixXd& X) {
    const Eigen::VectorXd& D = work.flux_weights;
    reflected_moments(work.mu_over_flux_weights, X, mode, work.phi);
    work.phi += mode.at_nodes;
    work.weighted = work.phi * work.alternating.asDiagonal();
    work.square.resize(X.rows(), X.cols());
    work.square.noalias() = work.weighted * work.phi.transpose();
    for (Eigen::Index q = 0; q < X.cols(); ++q) {
        X.col(q) =
            0.5 * D[q] * D.array() * work.square.col(q).array() / (grid.mu.array() + grid.mu[q]);
    }
    X.triangularView<Eigen::StrictlyLower>() = X.transpose();  // reciprocity, exactly
}

// The same without its first term (Y Y), at the requested pairs.
void fill_multiple(const FourierMode& mode, const RequestedDirections& requested, FourierWork& work,
                   Reflector& result) {
    reflected_moments(requested.mu, result.rows, mode, work.moments);
    result.multiple.setZero(Eigen::Index(requested.out.size()), Eigen::Index(requested.in.size()));
    work.products.add(work.alternating, work.moments, mode.at_out, mode.at_in, requested,
                      result.multiple);
    divide_by_cosines(requested, result.multiple);
}

// Upward radiance at mu from the source function integrated to infinite depth. Each eigenmode
// decays as exp(-k tau), so its integral is 1 / (1 + mu k).
void fill_rows_from_eigenmodes(const FourierMedium& medium, const FourierMode& mode,
                               const RequestedDirections& requested, FourierWork& work,
                               Reflector& result) {
    const Eigenmodes& eigenmodes = work.eigenmode_solver.eigenmodes();
    work.sources.find(medium, mode, eigenmodes);
    Eigen::MatrixXd& weights = work.sources.even;
    for (Eigen::Index j = 0; j < weights.cols(); ++j) {
        const double k = eigenmodes.rates[j];
        weights.col(j).array() = 0.5 *
                                 (weights.col(j).array() - k * work.sources.odd.col(j).array()) /
                                 (1.0 + k * requested.mu.array());
    }
    work.rows.resize(weights.rows(), eigenmodes.vectors.rows());
    work.rows.noalias() = weights * eigenmodes.vectors.transpose();
    result.rows = work.rows;
    result.rows.noalias() += work.rows * result.nodes;  // s = (I + X) i_down at the surface
}

// In closed form. False if there is no physical solution.
bool solve_by_eigenmodes(const FourierMedium& medium, const FourierMode& mode,
                         const ZenithGrid& grid, const RequestedDirections& requested,
                         double tolerance, FourierWork& work, Reflector& result) {
    const Eigenmodes& eigenmodes = work.eigenmode_solver.find(mode, medium, grid, tolerance);
    if (!eigenmodes.physical) return false;
    work.eigenmode_solver.function(eigenmodes.rates.array(), work.square);
    work.square.diagonal().array() += 1.0;
    if (!math::invert_positive_definite(work.square, result.nodes)) return false;
    result.nodes *= 2.0;
    result.nodes.diagonal().array() -= 1.0;
    apply_equation_at_nodes(mode, grid, work, result.nodes);
    fill_rows_from_eigenmodes(medium, mode, requested, work, result);
    return true;
}

// The row of Ambartsumian's equation at each cosine, for any X that satisfies it at the nodes:
// r (I + mu (P - Q X)) = [(E - O) + (E + O) X] / 2, P = (U + V) / 2, Q = (V - U) / 2.
void fill_rows_by_solving(const FourierMedium& medium, const FourierMode& mode,
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

void solve_half_space(HalfSpaceMethod method, const FourierMedium& medium, const FourierMode& mode,
                      const ZenithGrid& grid, const RequestedDirections& requested,
                      double tolerance, FourierWork& work, Reflector& result) {
    work.flux_weights = (grid.weights.array() * grid.mu.array()).sqrt();
    work.mu_over_flux_weights = grid.mu.cwiseQuotient(work.flux_weights);
    alternating(medium.strengths, work.alternating);
    result.specular.resize(0);
    if (method == HalfSpaceMethod::automatic) {
        result.iterations = 0;
        result.residual = 0.0;
        result.converged = true;
        if (few_sweeps_suffice(medium, tolerance)) {
            sweep_half_space(mode, grid, requested, tolerance, work, result);
            result.iterations = 0;
        } else {
            result.physical =
                solve_by_eigenmodes(medium, mode, grid, requested, tolerance, work, result);
        }
    } else {
        result = method == HalfSpaceMethod::fixed_point
                     ? iterate_half_space(medium, mode, grid, tolerance)
                     : double_to_half_space(medium, mode, grid, tolerance);
        if (result.physical) fill_rows_by_solving(medium, mode, grid, requested, result);
    }
    if (result.physical) fill_multiple(mode, requested, work, result);
}

Reflector solve_half_space(HalfSpaceMethod method, const FourierMedium& medium,
                           const FourierMode& mode, const ZenithGrid& grid,
                           const RequestedDirections& requested, double tolerance) {
    FourierWork work;
    Reflector result;
    solve_half_space(method, medium, mode, grid, requested, tolerance, work, result);
    return result;
}

}  // namespace miebrdf::rte
