#include "rte/stokes/coupled.h"

#include <Eigen/LU>
#include <cmath>
#include <complex>

namespace miebrdf::rte {
namespace {

using Complex = std::complex<double>;
using ComplexArray = Eigen::ArrayXcd;
using ComplexMatrix = Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// (1 - exp(-z)) / z.
Complex decayed(Complex z) {
    if (std::abs(z) > 0.5) return (1.0 - std::exp(-z)) / z;
    Complex term = 1.0, sum = 1.0;  // 0.5^k / (k + 1)! falls below rounding at k = 13
    for (int k = 1; k < 14; ++k) {
        term *= -z / double(k + 1);
        sum += term;
    }
    return sum;
}

struct ComplexDecay {
    Complex near, far;
};

// decay_integrals for complex y, Re y > 0: x int_0^1 exp(-x u) sinh(y (1-u)) / sinh(y) du and the
// same with sinh(y u).
ComplexDecay decay_integrals(double x, Complex y) {
    // (exp(-y) - exp(-x)) / (x - y), whichever decays more slowly taken out.
    const Complex between =
        y.real() <= x ? std::exp(-y) * decayed(x - y) : std::exp(-x) * decayed(y - x);
    const Complex scale = x / (2.0 * y * decayed(2.0 * y));
    const Complex sum = decayed(x + y), direct = std::exp(-y);
    return {scale * (sum - direct * between), scale * (between - direct * sum)};
}

// F Z^ h F^T in its blocks.
struct Impedance {
    MatrixXd linear, mixed, circular;

    Impedance(const CoupledModes& modes, const MatrixXd& function) {
        const Eigen::Index k = modes.S.rows(), n = function.rows();
        const MatrixXd& F = modes.linear().vectors;
        const MatrixXd& G = modes.circular().vectors;
        MatrixXd Z(n, n);
        Z << modes.S, modes.K, -modes.K.transpose(), modes.T;
        const MatrixXd product = Z * function;
        linear = F * product.topLeftCorner(k, k) * F.transpose();
        mixed = F * product.topRightCorner(k, n - k) * G.transpose();
        circular = G * product.bottomRightCorner(n - k, n - k) * G.transpose();
        linear = (0.5 * (linear + linear.transpose())).eval();
        circular = (0.5 * (circular + circular.transpose())).eval();
    }
};

// (I + Z)^-1.
bool inverse_of(const Impedance& Z, int rows_per_node, MatrixXd& result) {
    if (!reflection_of(Z.linear, Z.mixed, Z.circular, rows_per_node, result)) return false;
    result.diagonal().array() += 1.0;
    result *= 0.5;
    return true;
}

// Works as solve_layer does, mode by mode, for light from both sides alike and with opposite signs.
void fill_rows(double tau, const VectorXd& mu, const math::ComplexEigen& modes,
               const CoupledSources& sources, const CoupledModes& coupled, int rows_per_node,
               LayerOperator& layer) {
    const ComplexMatrix even = sources.even * modes.vectors, odd = sources.odd * modes.vectors;
    ComplexMatrix alike(even.rows(), even.cols()), opposite(even.rows(), even.cols());
    for (Eigen::Index j = 0; j < even.cols(); ++j) {
        const Complex y = tau * modes.values[j];
        const Complex tanh = 0.5 * y * decayed(y) / (1.0 - 0.5 * y * decayed(y));
        for (Eigen::Index r = 0; r < even.rows(); ++r) {
            const ComplexDecay decay = decay_integrals(tau / mu[r], y);
            const Complex sum = decay.near + decay.far, difference = decay.near - decay.far;
            alike(r, j) = even(r, j) * sum - odd(r, j) * difference * tanh;
            opposite(r, j) = even(r, j) * difference - odd(r, j) * sum / tanh;
        }
    }
    const MatrixXd from_alike =
        0.5 * sources_at_nodes(coupled, (alike * modes.inverse).real(), rows_per_node) *
        layer.alike;
    const MatrixXd from_opposite =
        0.5 * sources_at_nodes(coupled, (opposite * modes.inverse).real(), rows_per_node) *
        layer.opposite;
    layer.reflection_rows = from_alike + from_opposite;
    layer.transmission_rows = from_alike - from_opposite;
}

}  // namespace

MatrixXd TwistedRows::times(const MatrixXd& rows, int rows_per_node) const {
    MatrixXd result = diagonal.asDiagonal() * rows;
    for (Eigen::Index u = rows_per_node - 2; u < rows.rows(); u += rows_per_node) {
        result.row(u) += twist[u] * rows.row(u + 1);
        result.row(u + 1) += twist[u + 1] * rows.row(u);
    }
    return result;
}

TwistedRows TwistedRows::following(const TwistedRows& other, int rows_per_node) const {
    TwistedRows product{diagonal.cwiseProduct(other.diagonal), VectorXd::Zero(diagonal.size())};
    for (Eigen::Index u = rows_per_node - 2; u < diagonal.size(); u += rows_per_node) {
        for (const Eigen::Index r : {u, u + 1}) {
            product.diagonal[r] += twist[r] * other.twist[2 * u + 1 - r];
            product.twist[r] = diagonal[r] * other.twist[r] + twist[r] * other.diagonal[r];
        }
    }
    return product;
}

MatrixXd TwistedRows::of_node(Eigen::Index node, int rows_per_node) const {
    const Eigen::Index c = rows_per_node, first = node * c;
    MatrixXd matrix = diagonal.segment(first, c).asDiagonal();
    matrix(c - 2, c - 1) = twist[first + c - 2];
    matrix(c - 1, c - 2) = twist[first + c - 1];
    return matrix;
}

TwistedRows specular_of(const Reflector& reflector, Eigen::Index rows) {
    if (reflector.specular.size() == 0) return {VectorXd::Zero(rows), VectorXd::Zero(rows)};
    return {reflector.specular, reflector.specular_twist};
}

MatrixXd arriving(const MatrixXd& rows, const std::vector<int>& which, int rows_per_node) {
    MatrixXd columns(rows.cols(), Eigen::Index(which.size()));
    for (std::size_t k = 0; k < which.size(); ++k) {
        columns.col(Eigen::Index(k)) = rows.row(which[k]).transpose();
        if (which[k] % rows_per_node == rows_per_node - 1) columns.col(Eigen::Index(k)) *= -1.0;
    }
    return metric(rows.cols(), rows_per_node).asDiagonal() * columns;
}

void solve_coupled_layer(double tau, const StokesTables& tables, const StokesBlock& block,
                         const MatrixStrengths& strengths, const FourierMode& mode,
                         const FourierMedium& medium, const ZenithGrid& nodes,
                         const RequestedDirections& cosines, const RequestedDirections& requested,
                         double tolerance, CoupledWork& work, LayerOperator& layer) {
    const int c = int(block.size());
    CoupledModes& coupled = work.modes;
    layer.physical =
        coupled.find(tables, block, strengths, medium.one_minus_albedo, nodes, cosines, tolerance);
    if (!layer.physical) return;
    math::ComplexEigen modes;  // of the rates
    layer.physical = modes.compute(coupled.rates) && modes.values.real().minCoeff() > 0.0;
    if (!layer.physical) return;
    const ComplexArray y = tau * modes.values.array();
    const ComplexArray half = 0.5 * y * y.unaryExpr([](Complex z) { return decayed(z); });
    const ComplexArray tanh = half / (1.0 - half);  // (1 - e^-y) / (1 + e^-y)
    const ComplexArray sinh =
        (-y).exp() / (y * y.unaryExpr([](Complex z) { return decayed(2.0 * z); }));
    const Impedance thin(coupled, modes.function(tanh));
    const Impedance coupling(coupled, modes.function(sinh));
    Impedance thick = thin;
    thick.linear += 2.0 * coupling.linear;
    thick.mixed += 2.0 * coupling.mixed;
    thick.circular += 2.0 * coupling.circular;
    layer.physical = inverse_of(thin, c, layer.alike) && inverse_of(thick, c, layer.opposite);
    if (!layer.physical) return;
    layer.reflection = layer.alike + layer.opposite;
    layer.reflection.diagonal().array() -= 1.0;
    layer.coupling = joined(coupling.linear, coupling.mixed, coupling.circular, c);
    layer.transmission = 2.0 * layer.alike * layer.coupling * layer.opposite;
    layer.direct = (-tau / requested.mu.array()).exp();
    fill_rows(tau, requested.mu, modes, sources_of(mode, medium, coupled, c), coupled, c, layer);
    alternating(medium.strengths, work.fourier.alternating);
    fill_layer_pairs(mode, requested, work.fourier, layer);
    const VectorXd J = metric(layer.multiple.cols(), c);
    layer.multiple *= J.asDiagonal();
    if (requested.beside.empty()) return;
    fill_transmitted(medium, mode, requested, layer);
    layer.transmitted_multiple *= J.asDiagonal();
}

namespace {

// Light that the base's mirror sends into the layer or receives from it.
void add_mirrored_pairs(const LayerOperator& layer, const TwistedRows& back,
                        const RequestedDirections& requested, int c, MatrixXd& multiple) {
    for (Eigen::Index i = 0; i < multiple.cols(); i += c) {
        const MatrixXd in = back.of_node(requested.in[std::size_t(i)] / c, c);
        for (Eigen::Index o = 0; o < multiple.rows(); o += c) {
            const MatrixXd out = back.of_node(requested.out[std::size_t(o)] / c, c);
            const MatrixXd through = layer.transmitted_multiple.block(o, i, c, c);
            multiple.block(o, i, c, c) +=
                through * in + out * through + out * layer.multiple.block(o, i, c, c) * in;
        }
    }
}

}  // namespace

void put_on_coupled(const LayerOperator& layer, const Reflector& base,
                    const RequestedDirections& requested, int rows_per_node, ReflectorParts parts,
                    Reflector& result) {
    const int c = rows_per_node;
    const Eigen::Index n = base.nodes.rows();
    result.iterations = base.iterations;
    result.residual = base.residual;
    result.converged = base.converged;
    result.physical = true;
    result.has_transmittance = false;
    const bool has_mirror = base.specular.size() > 0;
    // A beam down to the mirror and up again through the layer.
    const TwistedRows direct{layer.direct, VectorXd::Zero(layer.direct.size())};
    const TwistedRows back = direct.following(specular_of(base, layer.direct.size()), c);
    result.specular.resize(0);
    result.specular_twist.resize(0);
    MatrixXd mirrored = layer.transmission_rows;
    if (has_mirror) {
        mirrored += back.times(layer.reflection_rows, c);
        const TwistedRows specular = direct.following(back, c);
        result.specular = specular.diagonal;
        result.specular_twist = specular.twist;
    }
    // down = (through + X_c up), up = X_b down + beam.
    const Eigen::PartialPivLU<MatrixXd> bounces(MatrixXd::Identity(n, n) -
                                                layer.reflection * base.nodes);
    const MatrixXd seen = layer.direct.asDiagonal() * base.rows;
    if (parts == ReflectorParts::nodes) {
        const MatrixXd down = bounces.solve(layer.transmission);
        const MatrixXd up = base.nodes * down;
        result.nodes = layer.reflection + layer.transmission * up;
        result.rows = layer.reflection_rows + seen * down + mirrored * up;
        if (has_mirror) result.rows += back.times(layer.transmission_rows, c);
    }
    const MatrixXd beam = arriving(seen, requested.in, c);
    const MatrixXd through = arriving(mirrored, requested.in, c);
    const MatrixXd down = bounces.solve(through + layer.reflection * beam);
    const MatrixXd up = base.nodes * down + beam;
    const MatrixXd pairs = 0.5 * (seen * down + mirrored * up);
    result.multiple = layer.multiple;
    for (Eigen::Index i = 0; i < result.multiple.cols(); ++i) {
        const double direct_in = layer.direct[requested.in[std::size_t(i)]];
        for (Eigen::Index o = 0; o < result.multiple.rows(); ++o) {
            const int out = requested.out[std::size_t(o)];
            result.multiple(o, i) +=
                pairs(out, i) + layer.direct[out] * base.multiple(o, i) * direct_in;
        }
    }
    if (has_mirror) add_mirrored_pairs(layer, back, requested, c, result.multiple);
}

}  // namespace miebrdf::rte
