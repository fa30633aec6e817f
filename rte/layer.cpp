#include "rte/layer.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <cmath>

#include "rte/math/decay_integrals.h"

namespace miebrdf::rte {
namespace {

using Eigen::MatrixXd;

// h(k) of the impedances. k tanh(k tau/2) and k / sinh(k tau), the second -> 1 / tau.
double tanh_rate(double k, double tau) { return k * std::tanh(0.5 * k * tau); }

double sinh_rate(double k, double tau) {
    const double y = k * tau;
    if (y < 1e-8) return 1.0 / tau;
    return 2.0 * k * std::exp(-y) / -std::expm1(-2.0 * y);
}

struct DecayTables {
    MatrixXd near;  ///< requested x K, with the factor 1/2 of the source
    MatrixXd far;
};

DecayTables decay_tables(double tau, const TransferModes& modes, const Eigen::VectorXd& mu) {
    DecayTables tables;
    math::decay_integrals(tau / mu.array(), tau * modes.rates.array(), tables.near, tables.far);
    tables.near *= 0.5;
    tables.far *= 0.5;
    return tables;
}

// Radiance at the requested cosines, upward at the top and downward at the bottom, for light
// incident at each node on the top. Inside the layer s = i_up + i_down and a = i_down - i_up
// follow from their values at both ends, mode by mode: sinh(k (tau - t)) / sinh(k tau) of the top
// value and sinh(k t) / sinh(k tau) of the bottom value. The source at mu is (E s -+ O a) / 2.
void fill_rows(double tau, const TransferModes& modes, const MatrixXd& s_top,
               const ScatteringMode& medium, const PhaseMode& mode,
               const RequestedDirections& requested, LayerOperator& layer) {
    const MatrixXd even =
        (even_columns(mode.at_requested) * even_part(medium.strengths).asDiagonal() *
         even_columns(mode.scaled_nodes).transpose() * modes.odd) *
        modes.vectors;  // F^-T = V F
    const MatrixXd odd = odd_columns(mode.at_requested) * odd_part(medium.strengths).asDiagonal() *
                         odd_columns(mode.scaled_nodes).transpose() * modes.vectors;
    const auto [near, far] = decay_tables(tau, modes, requested.mu);
    const MatrixXd F_transposed = modes.vectors.transpose();
    const MatrixXd s_near = even.cwiseProduct(near) * F_transposed;
    const MatrixXd s_far = even.cwiseProduct(far) * F_transposed;
    const MatrixXd a_near = (odd.cwiseProduct(near) * F_transposed) * modes.odd;
    const MatrixXd a_far = (odd.cwiseProduct(far) * F_transposed) * modes.odd;

    MatrixXd a_top = -s_top;
    a_top.diagonal().array() += 2.0;              // s = I + X, a = I - X
    const MatrixXd& bottom = layer.transmission;  // s = a = T: nothing comes from below
    layer.reflection_rows = s_near * s_top - a_near * a_top + (s_far - a_far) * bottom;
    layer.transmission_rows = s_far * s_top + a_far * a_top + (s_near + a_near) * bottom;
}

// Chandrasekhar's X and Y functions: R = sum_l (-1)^(l-m) a_l (phi phi' - psi psi') /
// (4 (mu + mu')), with psi the moments of the radiance at the bottom; without the first order.
void fill_multiple(const ScatteringMode& medium, const PhaseMode& mode,
                   const RequestedDirections& requested, LayerOperator& layer) {
    const Eigen::VectorXd strengths = alternating(medium.strengths);
    const MatrixXd& Y = mode.at_requested;
    const MatrixXd phi = reflected_moments(requested.mu, layer.reflection_rows, mode);
    const MatrixXd psi = requested.mu.asDiagonal() * (layer.transmission_rows * mode.scaled_nodes);
    const MatrixXd Y_below = layer.direct.asDiagonal() * Y;

    const auto product = [&](const MatrixXd& first, const MatrixXd& extra) -> MatrixXd {
        const MatrixXd first_out = first(requested.out, Eigen::all);
        const MatrixXd extra_out = extra(requested.out, Eigen::all);
        const MatrixXd first_in = first(requested.in, Eigen::all);
        const MatrixXd extra_in = extra(requested.in, Eigen::all);
        return first_out * strengths.asDiagonal() * extra_in.transpose() +
               extra_out * strengths.asDiagonal() * (first_in + extra_in).transpose();
    };
    layer.multiple = product(Y, phi) - product(Y_below, psi);
    for (Eigen::Index i = 0; i < layer.multiple.cols(); ++i) {
        for (Eigen::Index o = 0; o < layer.multiple.rows(); ++o) {
            layer.multiple(o, i) /=
                4.0 * (requested.mu[requested.out[o]] + requested.mu[requested.in[i]]);
        }
    }
}

}  // namespace

LayerOperator solve_layer(double optical_depth, const ScatteringMode& medium, const PhaseMode& mode,
                          const ZenithGrid& grid, const RequestedDirections& requested) {
    const double tau = optical_depth;
    const Eigen::Index n = grid.size();
    LayerOperator layer;
    const TransferModes modes = decompose(mode, medium.strengths, medium.one_minus_albedo, grid);
    if (!modes.physical) return layer;
    layer.thin_impedance =
        modes.function(modes.rates.array().unaryExpr([=](double k) { return tanh_rate(k, tau); }));
    layer.coupling =
        modes.function(modes.rates.array().unaryExpr([=](double k) { return sinh_rate(k, tau); }));

    const MatrixXd identity = MatrixXd::Identity(n, n);
    const Eigen::LLT<MatrixXd> symmetric(identity + layer.thin_impedance);
    const Eigen::LLT<MatrixXd> antisymmetric(identity + layer.thin_impedance +
                                             2.0 * layer.coupling);
    if (symmetric.info() != Eigen::Success || antisymmetric.info() != Eigen::Success) return layer;
    const MatrixXd s_top = symmetric.solve(identity) + antisymmetric.solve(identity);
    layer.reflection = s_top - identity;
    layer.transmission = 2.0 * symmetric.solve(antisymmetric.solve(layer.coupling).transpose());
    layer.direct = (-tau / requested.mu.array()).exp();
    fill_rows(tau, modes, s_top, medium, mode, requested, layer);
    fill_multiple(medium, mode, requested, layer);
    layer.physical = true;
    return layer;
}

Reflector put_on(const LayerOperator& layer, const Reflector& base, const ZenithGrid& grid,
                 const RequestedDirections& requested) {
    const Eigen::Index n = grid.size();
    const MatrixXd identity = MatrixXd::Identity(n, n);
    Reflector result;
    result.iterations = base.iterations;
    result.residual = base.residual;
    result.converged = base.converged;

    const Eigen::LLT<MatrixXd> base_factor(identity + base.nodes);
    if (base_factor.info() != Eigen::Success) return result;
    const MatrixXd below = layer.thin_impedance + 2.0 * base_factor.solve(identity) - identity;
    const Eigen::LLT<MatrixXd> joint(layer.coupling + below);
    if (joint.info() != Eigen::Success) return result;
    MatrixXd impedance = layer.thin_impedance + layer.coupling * joint.solve(below);
    impedance.diagonal().array() += 1.0;
    const Eigen::LLT<MatrixXd> total(0.5 * (impedance + impedance.transpose()));
    if (total.info() != Eigen::Success) return result;
    result.nodes = 2.0 * total.solve(identity) - identity;

    // Radiance at the interface for light incident at each requested cosine, columns:
    // down = t + X_c up, up = X_base down + exp(-tau / mu) rho_base.
    const MatrixXd seen = layer.direct.asDiagonal() * base.rows;
    const Eigen::PartialPivLU<MatrixXd> bounces(identity - layer.reflection * base.nodes);
    const MatrixXd down =
        bounces.solve(layer.transmission_rows.transpose() + layer.reflection * seen.transpose());
    const MatrixXd up = base.nodes * down + seen.transpose();
    result.rows = layer.reflection_rows + (layer.transmission * up).transpose();

    const MatrixXd down_in = down(Eigen::all, requested.in);
    const MatrixXd up_in = up(Eigen::all, requested.in);
    const MatrixXd seen_out = seen(requested.out, Eigen::all);
    const MatrixXd through_out = layer.transmission_rows(requested.out, Eigen::all);
    const Eigen::VectorXd direct_in = layer.direct(requested.in);
    const Eigen::VectorXd direct_out = layer.direct(requested.out);
    result.multiple = layer.multiple +
                      direct_out.asDiagonal() * base.multiple * direct_in.asDiagonal() +
                      0.5 * (seen_out * down_in + through_out * up_in);
    result.physical = true;
    return result;
}

}  // namespace miebrdf::rte
