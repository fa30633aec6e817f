#include "rte/layer/layer.h"

#include <cmath>

#include "rte/fourier/eigenmodes.h"
#include "rte/math/matrices.h"

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

// Light from both sides alike, and from both with opposite signs, part: `alike` = (I + Z_p)^-1 and
// `opposite` = (I + Z_m)^-1. False if they have no physical solution.
bool fill_nodes(ReflectorParts parts, FourierWork& work, LayerOperator& layer) {
    work.eigenmode_solver.function(work.tanh_rates.array(), layer.thin_impedance);
    work.eigenmode_solver.function(work.sinh_rates.array(), layer.coupling);
    work.square = layer.thin_impedance;
    work.square.diagonal().array() += 1.0;
    work.other_square = work.square + 2.0 * layer.coupling;
    if (!math::invert_positive_definite(work.square, layer.alike)) return false;
    if (!math::invert_positive_definite(work.other_square, layer.opposite)) return false;
    layer.reflection = layer.alike + layer.opposite;
    layer.reflection.diagonal().array() -= 1.0;
    if (parts == ReflectorParts::nodes) {
        work.square.noalias() = layer.coupling * layer.opposite;
        layer.transmission.resize(work.square.rows(), work.square.cols());
        layer.transmission.noalias() = 2.0 * layer.alike * work.square;
    }
    return true;
}

// Radiance at the requested cosines, upward at the top and downward at the bottom, for light
// incident at each node on the top. Inside the layer s = i_up + i_down and a = i_down - i_up
// follow from their values at both ends, mode by mode: sinh(k (tau - t)) / sinh(k tau) of the top
// value and sinh(k t) / sinh(k tau) of the bottom value. The source at mu is (E s -+ O a) / 2.
void fill_rows(double tau, const RequestedDirections& requested, FourierWork& work,
               LayerOperator& layer) {
    const Eigenmodes& eigenmodes = work.eigenmode_solver.eigenmodes();
    work.eigenmode_solver.find_sources(work.sources);
    work.decays.set(tau, requested.mu);
    const Eigen::Index cosines = requested.mu.size();
    work.near.resize(cosines);
    work.far.resize(cosines);
    for (Eigen::Index j = 0; j < eigenmodes.rates.size(); ++j) {
        work.decays.integrate(tau * eigenmodes.rates[j], work.near, work.far);
        const double tanh = work.tanh_rates[j];
        const double coth = tanh + 2.0 * work.sinh_rates[j];
        // The sources of s and a become those of light from both sides alike and with opposite
        // signs.
        for (Eigen::Index r = 0; r < cosines; ++r) {
            const double sum = work.near[r] + work.far[r];
            const double difference = work.near[r] - work.far[r];
            double& even = work.sources.even(r, j);
            double& odd = work.sources.odd(r, j);
            const double alike = even * sum - odd * difference * tanh;
            const double opposite = even * difference - odd * sum * coth;
            even = alike;
            odd = opposite;
        }
    }
    const Eigen::Index n = eigenmodes.vectors.rows();
    work.rows.resize(cosines, n);
    layer.reflection_rows.resize(cosines, n);
    layer.transmission_rows.resize(cosines, n);
    work.rows.noalias() = 0.5 * work.sources.even * eigenmodes.vectors.transpose();
    layer.reflection_rows.noalias() = work.rows * layer.alike;
    work.rows.noalias() = 0.5 * work.sources.odd * eigenmodes.vectors.transpose();
    layer.transmission_rows.noalias() = work.rows * layer.opposite;
    work.rows = layer.transmission_rows;
    layer.transmission_rows = layer.reflection_rows - work.rows;
    layer.reflection_rows += work.rows;
}

}  // namespace

void fill_transmitted(const FourierMedium& medium, const FourierMode& mode,
                      const RequestedDirections& requested, LayerOperator& layer) {
    const auto& Y = mode.at_requested;
    const auto p = reflected_moments(requested.mu, layer.reflection_rows, mode);
    Eigen::MatrixXd s = layer.transmission_rows * mode.scaled_nodes;
    s = requested.mu.asDiagonal() * s;
    const auto numerator = [&](int o, int i) {
        double sum = 0.0;
        for (Eigen::Index c = 0; c < Y.cols(); ++c) {
            const double top_o = Y(o, c) + p(o, c), top_i = Y(i, c) + p(i, c);
            // Without Y Y of the direct beams.
            sum += medium.strengths[c] * (layer.direct[o] * Y(o, c) * p(i, c) + s(o, c) * top_i -
                                          (p(o, c) * layer.direct[i] * Y(i, c) + top_o * s(i, c)));
        }
        return sum;
    };
    const auto at = [&](int o, int i) {
        return numerator(o, i) / (4.0 * (requested.mu[o] - requested.mu[i]));
    };
    const int rows = mode.rows_per_node;
    layer.transmitted_multiple.resize(Eigen::Index(requested.out.size()),
                                      Eigen::Index(requested.in.size()));
    for (std::size_t i = 0; i < requested.in.size(); ++i) {
        for (std::size_t o = 0; o < requested.out.size(); ++o) {
            const int out = requested.out[o], in = requested.in[i];
            const bool is_straight = out / rows == in / rows;
            const int beside = is_straight ? requested.beside[std::size_t(in)] : -1;
            layer.transmitted_multiple(Eigen::Index(o), Eigen::Index(i)) =
                beside < 0 ? at(out, in) : 2.0 * at(out, beside) - at(out, beside + rows);
        }
    }
}

// psi are the moments of the radiance at the bottom.
void fill_layer_pairs(const FourierMode& mode, const RequestedDirections& requested,
                      FourierWork& work, LayerOperator& layer) {
    layer.multiple.setZero(Eigen::Index(requested.out.size()), Eigen::Index(requested.in.size()));
    reflected_moments(requested.mu, layer.reflection_rows, mode, work.moments);
    gather_rows(mode.at_requested, requested.out, work.first_out);
    gather_rows(mode.at_requested, requested.in, work.first_in);
    work.products.add(work.alternating, work.moments, work.first_out, work.first_in, requested,
                      layer.multiple);
    work.moments.noalias() = layer.transmission_rows * mode.scaled_nodes;
    for (Eigen::Index c = 0; c < work.moments.cols(); ++c) {
        work.moments.col(c).array() *= requested.mu.array();
    }
    work.products.subtract_below(work.alternating, work.moments, layer.direct, work.first_out,
                                 work.first_in, requested, layer.multiple);
    divide_by_cosines(requested, layer.multiple);
}

void LayerOperator::transmit(const Eigen::VectorXd& incident, Eigen::VectorXd& between,
                             Eigen::VectorXd& transmitted) const {
    transmitted.noalias() = opposite * incident;
    between.noalias() = coupling * transmitted;
    transmitted.noalias() = 2.0 * alike * between;
}

void solve_layer(double scaled_optical_depth, const FourierMedium& medium, const FourierMode& mode,
                 const ZenithGrid& grid, const RequestedDirections& requested, ReflectorParts parts,
                 double tolerance, FourierWork& work, LayerOperator& layer) {
    const double tau = scaled_optical_depth;
    layer.physical = false;
    const Eigenmodes& eigenmodes = work.eigenmode_solver.find(mode, medium, grid, tolerance);
    if (!eigenmodes.physical) return;
    work.tanh_rates = eigenmodes.rates.unaryExpr([=](double k) { return tanh_rate(k, tau); });
    work.sinh_rates = eigenmodes.rates.unaryExpr([=](double k) { return sinh_rate(k, tau); });
    if (!fill_nodes(parts, work, layer)) return;
    alternating(medium.strengths, work.alternating);
    layer.direct = (-tau / requested.mu.array()).exp();
    fill_rows(tau, requested, work, layer);
    fill_layer_pairs(mode, requested, work, layer);
    if (!requested.beside.empty()) fill_transmitted(medium, mode, requested, layer);
    layer.physical = true;
}

LayerOperator solve_layer(double scaled_optical_depth, const FourierMedium& medium,
                          const FourierMode& mode, const ZenithGrid& grid,
                          const RequestedDirections& requested) {
    FourierWork work;
    LayerOperator layer;
    solve_layer(scaled_optical_depth, medium, mode, grid, requested, ReflectorParts::nodes, 0.0,
                work, layer);
    return layer;
}

// A layer on something that reflects: adding.
namespace {

// X of both from the impedances. False if they have no physical solution.
bool join_impedances(const LayerOperator& layer, const MatrixXd& base, FourierWork& work,
                     MatrixXd& X) {
    // Z_base = 2 (I + X_base)^-1 - I, Y = Z_p + Z_base.
    work.square = base;
    work.square.diagonal().array() += 1.0;
    MatrixXd& below = work.below;
    if (!math::invert_positive_definite(work.square, below)) return false;
    below = layer.thin_impedance + 2.0 * below;
    below.diagonal().array() -= 1.0;
    work.square = layer.coupling + below;
    if (!math::invert_positive_definite(work.square, work.joint)) return false;
    work.square.noalias() = work.joint * below;
    work.other_square = layer.thin_impedance;
    work.other_square.diagonal().array() += 1.0;
    work.other_square.noalias() += layer.coupling * work.square;
    work.square = 0.5 * (work.other_square + work.other_square.transpose());
    if (!math::invert_positive_definite(work.square, X)) return false;
    X *= 2.0;
    X.diagonal().array() -= 1.0;
    return true;
}

// Radiance between layer and base for light incident at some of the requested cosines, columns:
// down = t + X_c up, up = X_base down + exp(-tau / mu) rho_base.
void fill_interface(const LayerOperator& layer, const Reflector& base, FourierWork& work) {
    work.incoming = work.through;
    work.incoming.noalias() += layer.reflection * work.beam;
    work.down.resize(work.incoming.rows(), work.incoming.cols());
    work.down = work.bounces.solve(work.incoming);
    work.up = work.beam;
    work.up.noalias() += base.nodes * work.down;
}

void gather_columns(const MatrixXd& rows, const std::vector<int>& which, Eigen::MatrixXd& columns) {
    columns.resize(rows.cols(), Eigen::Index(which.size()));
    for (std::size_t k = 0; k < which.size(); ++k) {
        columns.col(Eigen::Index(k)) = rows.row(which[k]).transpose();
    }
}

// Light that the base's mirror sends into the layer or receives from it.
void add_mirrored(const LayerOperator& layer, const Eigen::VectorXd& specular,
                  const RequestedDirections& requested, MatrixXd& multiple) {
    for (Eigen::Index i = 0; i < multiple.cols(); ++i) {
        const int in = requested.in[std::size_t(i)];
        const double back_in = layer.direct[in] * specular[in];
        for (Eigen::Index o = 0; o < multiple.rows(); ++o) {
            const int out = requested.out[std::size_t(o)];
            const double back_out = layer.direct[out] * specular[out];
            multiple(o, i) += layer.transmitted_multiple(o, i) * (back_in + back_out) +
                              layer.multiple(o, i) * back_in * back_out;
        }
    }
}

// R between requested cosines: of the layer, of the base seen through it, and of light that
// passes the interface. Reciprocity: the side with fewer cosines is the one that is lit.
void fill_pairs(const LayerOperator& layer, const Reflector& base,
                const RequestedDirections& requested, FourierWork& work, Reflector& result) {
    const MatrixXd& through = base.specular.size() > 0 ? work.mirrored : layer.transmission_rows;
    const bool out_is_lit = requested.out.size() < requested.in.size();
    const std::vector<int>& lit = out_is_lit ? requested.out : requested.in;
    const std::vector<int>& other = out_is_lit ? requested.in : requested.out;
    gather_columns(work.seen, lit, work.beam);
    gather_columns(through, lit, work.through);
    fill_interface(layer, base, work);
    gather_columns(work.seen, other, work.beam);
    gather_columns(through, other, work.through);
    work.pairs.resize(Eigen::Index(other.size()), Eigen::Index(lit.size()));
    work.pairs.noalias() = 0.5 * work.beam.transpose() * work.down;
    work.pairs.noalias() += 0.5 * work.through.transpose() * work.up;

    result.multiple = layer.multiple;
    if (out_is_lit) {
        result.multiple += work.pairs.transpose();
    } else {
        result.multiple += work.pairs;
    }
    for (Eigen::Index i = 0; i < result.multiple.cols(); ++i) {
        const double direct_in = layer.direct[requested.in[std::size_t(i)]];
        for (Eigen::Index o = 0; o < result.multiple.rows(); ++o) {
            result.multiple(o, i) +=
                layer.direct[requested.out[std::size_t(o)]] * base.multiple(o, i) * direct_in;
        }
    }
    if (base.specular.size() > 0) add_mirrored(layer, base.specular, requested, result.multiple);
}

// The answer to a sky: down = T sky + X_c up, up = X_base down.
void fill_sky(const LayerOperator& layer, const Reflector& base, const Eigen::VectorXd& sky,
              FourierWork& work, Reflector& result) {
    Eigen::VectorXd &down = work.downward, &up = work.upward;
    layer.transmit(sky, work.between, work.incident);
    down = work.bounces.solve(work.incident);
    up.noalias() = base.nodes * down;
    const bool has_mirror = base.specular.size() > 0;
    result.sky_at_requested.noalias() = layer.reflection_rows * sky;
    result.sky_at_requested.noalias() += work.seen * down;
    result.sky_at_requested.noalias() +=
        (has_mirror ? work.mirrored : layer.transmission_rows) * up;
    if (has_mirror) {
        result.sky_at_requested +=
            layer.direct.cwiseProduct(base.specular).asDiagonal() * (layer.transmission_rows * sky);
    }
    layer.transmit(up, work.between, result.sky_at_nodes);
    result.sky_at_nodes.noalias() += layer.reflection * sky;
}

/// Emission from below: up = U + X_base down, down = X_c up.
void fill_transmittance(const LayerOperator& layer, const Reflector& base, FourierWork& work,
                        Reflector& result) {
    const Eigen::VectorXd& below = base.transmittance_at_nodes;
    Eigen::VectorXd &down = work.downward, &up = work.upward;
    work.incident.noalias() = layer.reflection * below;
    down = work.bounces.solve(work.incident);
    up = below;
    up.noalias() += base.nodes * down;
    layer.transmit(up, work.between, result.transmittance_at_nodes);
    result.transmittance_at_requested = layer.direct.cwiseProduct(base.transmittance_at_requested);
    result.transmittance_at_requested.noalias() +=
        (base.specular.size() > 0 ? work.mirrored : layer.transmission_rows) * up;
    result.transmittance_at_requested.noalias() += work.seen * down;
}

}  // namespace

void put_on(const LayerOperator& layer, const Reflector& base, const RequestedDirections& requested,
            ReflectorParts parts, const Eigen::VectorXd& sky, FourierWork& work,
            Reflector& result) {
    const Eigen::Index n = base.nodes.rows();
    result.iterations = base.iterations;
    result.residual = base.residual;
    result.converged = base.converged;
    result.physical =
        parts != ReflectorParts::nodes || join_impedances(layer, base.nodes, work, result.nodes);
    if (!result.physical) return;

    work.seen = layer.direct.asDiagonal() * base.rows;
    work.square.resize(n, n);
    work.square.noalias() = -layer.reflection * base.nodes;
    work.square.diagonal().array() += 1.0;
    work.bounces.compute(work.square);
    const bool has_mirror = base.specular.size() > 0;
    const Eigen::VectorXd back =
        has_mirror ? Eigen::VectorXd(layer.direct.cwiseProduct(base.specular)) : Eigen::VectorXd();
    result.specular.resize(0);
    if (has_mirror) {
        // Light from a requested cosine arrives below directly and by way of the mirror.
        work.mirrored = layer.transmission_rows;
        work.mirrored.noalias() += back.asDiagonal() * layer.reflection_rows;
        result.specular = back.cwiseProduct(layer.direct);
    }
    if (parts == ReflectorParts::sky) fill_sky(layer, base, sky, work, result);
    result.has_transmittance = base.has_transmittance;
    if (base.has_transmittance) fill_transmittance(layer, base, work, result);
    if (parts == ReflectorParts::nodes) {
        work.beam = work.seen.transpose();
        if (has_mirror) {
            work.through = work.mirrored.transpose();
        } else {
            work.through = layer.transmission_rows.transpose();
        }
        fill_interface(layer, base, work);
        result.rows = layer.reflection_rows;
        if (has_mirror) result.rows.noalias() += back.asDiagonal() * layer.transmission_rows;
        result.rows.noalias() += work.up.transpose() * layer.transmission;  // T = T^T
    }
    fill_pairs(layer, base, requested, work, result);
}

}  // namespace miebrdf::rte
