#include "rte/half_space/half_space.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "rte/fourier/eigenmodes.h"
#include "rte/math/matrices.h"
#include "rte/math/tolerance_budget.h"

namespace miebrdf::rte {

Eigen::VectorXd flux_weights(const ZenithGrid& grid) {
    return (grid.weights.array() * grid.mu.array()).sqrt();
}

void reflected_moments(const Eigen::Ref<const Eigen::VectorXd>& mu,
                       const Eigen::Ref<const Eigen::MatrixXd>& rows, const FourierMode& mode,
                       Eigen::MatrixXd& moments) {
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

Eigen::MatrixXd reflected_moments(const Eigen::Ref<const Eigen::VectorXd>& mu,
                                  const Eigen::Ref<const Eigen::MatrixXd>& rows,
                                  const FourierMode& mode) {
    Eigen::MatrixXd moments;
    reflected_moments(mu, rows, mode, moments);
    return moments;
}

void no_reflection(const ZenithGrid& grid, const RequestedDirections& requested, Reflector& none) {
    none.nodes.setZero(grid.size(), grid.size());
    none.rows.setZero(requested.mu.size(), grid.size());
    none.multiple.setZero(Eigen::Index(requested.out.size()), Eigen::Index(requested.in.size()));
    none.specular.resize(0);
    none.has_transmittance = false;
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
    mirror.has_transmittance = false;
    mirror.iterations = 0;
    mirror.residual = 0.0;
    mirror.converged = mirror.physical = true;
}

void lambertian_ground(double albedo, const FourierMode& mode, const ZenithGrid& grid,
                       const RequestedDirections& requested, Reflector& ground) {
    no_reflection(grid, requested, ground);
    if (mode.fourier_order > 0 || !mode.has_intensity()) return;
    // In the memory of the sky's answer, which nobody has asked for yet.
    Eigen::VectorXd &D = ground.sky_at_nodes, &one = ground.sky_at_requested;
    D = (grid.weights.array() * grid.mu.array()).sqrt();
    mode.keep_intensity(D);
    // A rule that does not integrate mu exactly must still return the fraction `albedo` of the
    // flux.
    const double reflection = albedo * 0.5 / D.squaredNorm();
    one.setOnes(requested.mu.size());
    mode.keep_intensity(one);
    for (Eigen::Index q = 0; q < D.size(); ++q) {
        ground.nodes.col(q) = (2.0 * reflection * D[q]) * D;
        ground.rows.col(q) = (2.0 * reflection * D[q]) * one;
    }
    for (Eigen::Index i = 0; i < ground.multiple.cols(); ++i) {
        for (Eigen::Index o = 0; o < ground.multiple.rows(); ++o) {
            ground.multiple(o, i) =
                albedo * one[requested.out[std::size_t(o)]] * one[requested.in[std::size_t(i)]];
        }
    }
}

// Between nodes, eq. (3) factorises: 4 (mu_p + mu_q) R_pq = sum_l (-1)^(l-m) a_l phi_l(p) phi_l(q).
// With psi = (D/M) phi = (I +- X) y, + for even l - m, and the kernels E, O of both parities
//     Psi = (I + X) E (I + X) - (I - X) O (I - X) = B + X G + (X G)^T,  G = A + B X / 2,
// A = E + O (scattered to the same side), B = E - O (to the opposite one), and
//     X_pq = 2 D_p R_pq D_q = Psi_pq / (2 (1/mu_p + 1/mu_q)).
namespace {

// The kernels A and B between nodes and into the requested cosines, and what depends on the grid
// alone.
void form_sides(const FourierMedium& medium, const FourierMode& mode, const ZenithGrid& grid,
                FourierWork& work) {
    work.flux_weights = (grid.weights.array() * grid.mu.array()).sqrt();
    work.mu_over_flux_weights = grid.mu.cwiseQuotient(work.flux_weights);
    work.inverse_mu = grid.mu.cwiseInverse();
    const ScatteringKernels& kernels = work.eigenmode_solver.form_kernels(mode, medium);
    work.same_side = kernels.even + kernels.odd;
    work.opposite_side = kernels.even - kernels.odd;
    work.to_nodes.resize(work.inverse_mu.size(), work.inverse_mu.size());
    for (Eigen::Index q = 0; q < work.to_nodes.cols(); ++q)
        work.to_nodes.col(q) = 0.5 / (work.inverse_mu.array() + work.inverse_mu[q]);
    work.same_side_rows = kernels.even_rows + kernels.odd_rows;
    work.opposite_side_rows = kernels.even_rows - kernels.odd_rows;
}

// The steps still to come after one of the fixed point: each is at most `ratio` of the one before.
double left_after(double step, double ratio) { return step * ratio / (1.0 - ratio); }

// Psi of X into `psi`.
void fill_psi(const Eigen::MatrixXd& X, FourierWork& work, Eigen::MatrixXd& psi) {
    const Eigen::Index n = X.rows();
    work.gain = work.same_side;
    work.gain.noalias() += 0.5 * work.opposite_side * X;
    work.product.resize(n, n);
    work.product.noalias() = X * work.gain;
    psi.resize(n, n);
    psi = work.opposite_side + work.product + work.product.transpose();
}

void fill_nodes(const Eigen::MatrixXd& psi, const FourierWork& work, Eigen::MatrixXd& X) {
    X = psi.cwiseProduct(work.to_nodes);
    X.triangularView<Eigen::StrictlyLower>() = X.transpose();  // reciprocity, exactly
}

// The largest element of 4 (mu + mu') R = (M/D) Psi (M/D), which stays bounded: R grows like 1/mu
// at grazing angles and would hide errors everywhere else.
double largest_bounded(const Eigen::MatrixXd& psi, const FourierWork& work) {
    double largest = 0.0;
    for (Eigen::Index q = 0; q < psi.cols(); ++q) {
        const double at_column =
            (psi.col(q).array().abs() * work.mu_over_flux_weights.array()).maxCoeff();
        largest = std::max(largest, at_column * work.mu_over_flux_weights[q]);
    }
    return largest;
}

// Light scattered once alone is part of R between requested cosines, too, but is known in closed
// form: with T = mu rows, 4 (mu_o + mu_i) R is without it
//     T_o (A_i + T_i B)^T + A_o T_i^T.
void fill_multiple(const RequestedDirections& requested, FourierWork& work, Reflector& result) {
    const auto out = Eigen::Index(requested.out.size()), in = Eigen::Index(requested.in.size());
    work.rows = requested.mu.asDiagonal() * result.rows;
    gather_rows(work.rows, requested.in, work.reflected_in);
    gather_rows(work.rows, requested.out, work.reflected_out);
    gather_rows(work.same_side_rows, requested.in, work.scattered_in);
    gather_rows(work.same_side_rows, requested.out, work.scattered_out);
    work.scattered_in.noalias() += work.reflected_in * work.opposite_side;
    result.multiple.resize(out, in);
    result.multiple.noalias() = work.reflected_out * work.scattered_in.transpose();
    result.multiple.noalias() += work.scattered_out * work.reflected_in.transpose();
    divide_by_cosines(requested, result.multiple);
}

// Upward radiance at mu from the source function integrated to infinite depth. Each eigenmode
// decays as exp(-k tau), so its integral is 1 / (1 + mu k).
void fill_rows_from_eigenmodes(const RequestedDirections& requested, FourierWork& work,
                               Reflector& result) {
    const Eigenmodes& eigenmodes = work.eigenmode_solver.eigenmodes();
    work.eigenmode_solver.find_sources(work.sources);
    Eigen::MatrixXd& weights = work.sources.even;
    const Eigen::Index modes = eigenmodes.rates.size();
    for (Eigen::Index j = 0; j < modes; ++j) {
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
    const Eigenmodes& eigenmodes =
        work.eigenmode_solver.find_from_kernels(mode, medium, grid, tolerance);
    if (!eigenmodes.physical) return false;
    work.eigenmode_solver.function(eigenmodes.rates.array(), work.square);
    work.square.diagonal().array() += 1.0;
    if (!math::invert_positive_definite(work.square, result.nodes)) return false;
    result.nodes *= 2.0;
    result.nodes.diagonal().array() -= 1.0;
    fill_psi(result.nodes, work, work.square);
    work.brightness = largest_bounded(work.square, work);
    fill_nodes(work.square, work, result.nodes);
    fill_rows_from_eigenmodes(requested, work, result);
    return true;
}

// True where the fixed point converges in so few sweeps that it is cheaper than an eigenproblem:
// high Fourier orders, whose remaining moments are small.
bool few_sweeps_suffice(double ratio, double share) {
    constexpr double most_sweeps = 10.0;
    return ratio < 0.5 && std::log(share) > most_sweeps * std::log(std::max(ratio, 1e-30));
}

// The fixed point, without any linear system, until no more than `accuracy` of 4 (mu + mu') R is
// left to go; `single_scattering` is the largest of light scattered once.
bool sweep_half_space(const RequestedDirections& requested, double accuracy, double ratio,
                      double single_scattering, FourierWork& work, Reflector& result) {
    constexpr int most_sweeps = 40;
    Eigen::MatrixXd& psi = work.square;
    Eigen::MatrixXd& previous = work.other_square;
    psi = work.opposite_side;
    fill_nodes(psi, work, result.nodes);
    double step = single_scattering, slowest = ratio;
    const auto has_arrived = [&] { return left_after(step, std::min(slowest, 0.9)) <= accuracy; };
    int sweep = 0;
    for (; !has_arrived() && sweep < most_sweeps; ++sweep) {
        previous.swap(psi);
        fill_psi(result.nodes, work, psi);
        fill_nodes(psi, work, result.nodes);
        previous -= psi;
        const double next = largest_bounded(previous, work);
        slowest = std::max(ratio, next / step);
        step = next;
    }
    if (!has_arrived()) return false;
    // With X known, each requested cosine obeys a linear fixed point of its own:
    // 2 R(mu, mu_q) D_q = (B_r + A_r X + mu rows (A + B X))_q mu_q / (2 (mu + mu_q)).
    const Eigen::Index cosines = requested.mu.size(), n = result.nodes.rows();
    work.gain = work.same_side;
    work.gain.noalias() += work.opposite_side * result.nodes;
    work.seen = work.opposite_side_rows;
    work.seen.noalias() += work.same_side_rows * result.nodes;
    work.rows = work.seen;
    work.other_rows.resize(cosines, n);
    work.to_rows.resize(cosines, n);
    for (Eigen::Index q = 0; q < n; ++q)
        work.to_rows.col(q) = 0.5 / (1.0 + work.inverse_mu[q] * requested.mu.array());
    result.rows = work.rows.cwiseProduct(work.to_rows);
    step = single_scattering;
    for (sweep = 0; !(left_after(step, ratio) <= accuracy); ++sweep) {
        if (sweep == most_sweeps) return false;
        work.other_rows.swap(work.rows);
        result.rows = requested.mu.asDiagonal() * result.rows;
        work.rows = work.seen;
        work.rows.noalias() += result.rows * work.gain;
        result.rows = work.rows.cwiseProduct(work.to_rows);
        step = 0.0;
        for (Eigen::Index q = 0; q < n && cosines > 0; ++q) {
            step =
                std::max(step, (work.rows.col(q) - work.other_rows.col(q)).cwiseAbs().maxCoeff() *
                                   work.mu_over_flux_weights[q]);
        }
    }
    return result.nodes.allFinite() && result.rows.allFinite();
}

// The row of Ambartsumian's equation at each cosine, for any X that satisfies it at the nodes:
// r (I + mu (P - Q X)) = [(E - O) + (E + O) X] / 2, P = (U + V) / 2, Q = (V - U) / 2.
void fill_rows_by_solving(const ZenithGrid& grid, const RequestedDirections& requested,
                          const FourierWork& work, Reflector& result) {
    const Eigen::Index n = grid.size();
    const Eigen::MatrixXd sources =
        0.5 * (work.opposite_side_rows + work.same_side_rows * result.nodes);
    Eigen::MatrixXd propagator = -0.5 * work.same_side - 0.5 * work.opposite_side * result.nodes;
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
    form_sides(medium, mode, grid, work);
    result.specular.resize(0);
    result.has_transmittance = false;
    if (method == HalfSpaceMethod::automatic) {
        result.iterations = 0;
        result.residual = 0.0;
        result.converged = true;
        const double single_scattering = largest_bounded(work.opposite_side, work);
        const double accuracy =
            tolerance * std::max(single_scattering, kHigherOrderShare * medium.brightness);
        const double ratio = medium.strongest();
        result.physical =
            few_sweeps_suffice(ratio,
                               single_scattering > 0.0 ? accuracy / single_scattering : 1.0) &&
            sweep_half_space(requested, accuracy, ratio, single_scattering, work, result);
        work.is_swept = result.physical;
        if (result.physical) {
            work.brightness = largest_bounded(work.square, work);
        } else {
            result.physical =
                solve_by_eigenmodes(medium, mode, grid, requested, tolerance, work, result);
        }
    } else {
        result = method == HalfSpaceMethod::fixed_point
                     ? iterate_half_space(medium, mode, grid, tolerance)
                     : double_to_half_space(medium, mode, grid, tolerance);
        if (result.physical) fill_rows_by_solving(grid, requested, work, result);
    }
    if (result.physical) fill_multiple(requested, work, result);
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
