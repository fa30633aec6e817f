#include "rte/layer.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <cmath>

#include "rte/math/decay_integrals.h"
#include "rte/mode_sources.h"

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

// Radiance at the requested cosines, upward at the top and downward at the bottom, for light
// incident at each node on the top. Inside the layer s = i_up + i_down and a = i_down - i_up
// follow from their values at both ends, mode by mode: sinh(k (tau - t)) / sinh(k tau) of the top
// value and sinh(k t) / sinh(k tau) of the bottom value. The source at mu is (E s -+ O a) / 2.
// Light from both sides alike, and from both with opposite signs, part: `alike` = (I + Z_p)^-1 and
// `opposite` = (I + Z_m)^-1 are R + T and R - T (plus I, halved), and need half the products.
void fill_rows(double tau, const TransferModes& modes, const MatrixXd& alike,
               const MatrixXd& opposite, const ScatteringMode& medium, const PhaseMode& mode,
               const RequestedDirections& requested, LayerOperator& layer) {
    const auto [even, odd] = mode_sources(medium, mode, modes);
    MatrixXd near;
    MatrixXd far;
    math::decay_integrals(tau / requested.mu.array(), tau * modes.rates.array(), near, far);
    const Eigen::ArrayXd tanh_rates =
        modes.rates.array().unaryExpr([=](double k) { return tanh_rate(k, tau); });
    const Eigen::ArrayXd coth_rates = tanh_rates + modes.rates.array().unaryExpr([=](double k) {
        return 2.0 * sinh_rate(k, tau);
    });
    const MatrixXd sum = near + far;
    const MatrixXd difference = near - far;
    const MatrixXd of_alike =
        even.cwiseProduct(sum) - odd.cwiseProduct(difference) * tanh_rates.matrix().asDiagonal();
    const MatrixXd of_opposite =
        even.cwiseProduct(difference) - odd.cwiseProduct(sum) * coth_rates.matrix().asDiagonal();
    const MatrixXd from_alike = of_alike * (modes.vectors.transpose() * alike);
    const MatrixXd from_opposite = of_opposite * (modes.vectors.transpose() * opposite);
    layer.reflection_rows = 0.5 * (from_alike + from_opposite);
    layer.transmission_rows = 0.5 * (from_alike - from_opposite);
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

// X of both from the impedances. False if they have no physical solution.
bool join_impedances(const LayerOperator& layer, const MatrixXd& base, MatrixXd& X) {
    const MatrixXd identity = MatrixXd::Identity(base.rows(), base.cols());
    const Eigen::LLT<MatrixXd> base_factor(identity + base);
    if (base_factor.info() != Eigen::Success) return false;
    const MatrixXd below = layer.thin_impedance + 2.0 * base_factor.solve(identity) - identity;
    const Eigen::LLT<MatrixXd> joint(layer.coupling + below);
    if (joint.info() != Eigen::Success) return false;
    const MatrixXd impedance =
        identity + layer.thin_impedance + layer.coupling * joint.solve(below);
    const Eigen::LLT<MatrixXd> total(0.5 * (impedance + impedance.transpose()));
    if (total.info() != Eigen::Success) return false;
    X = 2.0 * total.solve(identity) - identity;
    return true;
}

// Radiance between layer and base, n x (incident cosines).
struct Interface {
    MatrixXd down;
    MatrixXd up;
};

}  // namespace

LayerOperator solve_layer(double optical_depth, const ScatteringMode& medium, const PhaseMode& mode,
                          const ZenithGrid& grid, const RequestedDirections& requested,
                          ReflectorParts parts) {
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
    const MatrixXd alike = symmetric.solve(identity);
    const MatrixXd opposite = antisymmetric.solve(identity);
    layer.reflection = alike + opposite - identity;
    if (parts >= ReflectorParts::rows) {
        layer.transmission = 2.0 * symmetric.solve(antisymmetric.solve(layer.coupling).transpose());
    }
    layer.direct = (-tau / requested.mu.array()).exp();
    fill_rows(tau, modes, alike, opposite, medium, mode, requested, layer);
    fill_multiple(medium, mode, requested, layer);
    layer.physical = true;
    return layer;
}

Reflector put_on(const LayerOperator& layer, const Reflector& base,
                 const RequestedDirections& requested, ReflectorParts parts) {
    const Eigen::Index n = base.nodes.rows();
    Reflector result;
    result.iterations = base.iterations;
    result.residual = base.residual;
    result.converged = base.converged;
    if (parts == ReflectorParts::nodes && !join_impedances(layer, base.nodes, result.nodes)) {
        return result;
    }

    // Radiance at the interface for light incident at requested cosines, columns:
    // down = t + X_c up, up = X_base down + exp(-tau / mu) rho_base.
    const MatrixXd seen = layer.direct.asDiagonal() * base.rows;
    const Eigen::PartialPivLU<MatrixXd> bounces(MatrixXd::Identity(n, n) -
                                                layer.reflection * base.nodes);
    const auto interface_for = [&](const auto& which) {
        const MatrixXd beam = seen(which, Eigen::all).transpose();
        Interface light;
        light.down = bounces.solve(layer.transmission_rows(which, Eigen::all).transpose() +
                                   layer.reflection * beam);
        light.up = base.nodes * light.down + beam;
        return light;
    };
    const Interface incident = interface_for(requested.in);
    if (parts >= ReflectorParts::rows) {
        const Interface all = interface_for(Eigen::all);
        result.rows = layer.reflection_rows + (layer.transmission * all.up).transpose();
    }

    const MatrixXd seen_out = seen(requested.out, Eigen::all);
    const MatrixXd through_out = layer.transmission_rows(requested.out, Eigen::all);
    const Eigen::VectorXd direct_in = layer.direct(requested.in);
    const Eigen::VectorXd direct_out = layer.direct(requested.out);
    result.multiple = layer.multiple +
                      direct_out.asDiagonal() * base.multiple * direct_in.asDiagonal() +
                      0.5 * (seen_out * incident.down + through_out * incident.up);
    result.physical = true;
    return result;
}

}  // namespace miebrdf::rte
