// Two textbook solvers for one azimuthal order: adding-doubling and discrete ordinates.
#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include <cmath>

#include "tools/bench/discrete_problem.h"

namespace miebrdf::bench {
namespace {

// Diffuse reflection and transmission of a slab as functions R(mu, mu'), and its direct beam.
struct Slab {
    Eigen::MatrixXd R, T;
    Eigen::VectorXd E;
};

// AllDirections of an order: nodes first, then user angles, which carry no weight.
struct AllDirections {
    Eigen::VectorXd mu, measure;  // measure: 2 mu w
    Eigen::MatrixXd y;

    explicit AllDirections(const Order& order) {
        const Eigen::Index n = order.mu.size(), u = order.user_mu.size();
        mu.resize(n + u);
        mu << order.mu, order.user_mu;
        measure = Eigen::VectorXd::Zero(n + u);
        measure.head(n) = 2 * order.mu.cwiseProduct(order.weights);
        y.resize(n + u, order.nodes.cols());
        y << order.nodes, order.user;
        n_ = n;
    }

    // Integral over the directions in between: only nodes have weight.
    Eigen::MatrixXd star(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) const {
        return a.leftCols(n_) * measure.head(n_).asDiagonal() * b.topRows(n_);
    }

    // S = Q + Q*Q + ... with Q = a*b, the light that goes to and fro.
    Eigen::MatrixXd repeated(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) const {
        const Eigen::MatrixXd q = star(a, b);
        Eigen::MatrixXd system = -q.topLeftCorner(n_, n_) * measure.head(n_).asDiagonal();
        system.diagonal().array() += 1;
        const Eigen::MatrixXd top = system.partialPivLu().solve(q.topRows(n_));
        return q + q.leftCols(n_) * measure.head(n_).asDiagonal() * top;
    }

  private:
    Eigen::Index n_ = 0;
};

Slab thin_layer(const Order& order, const AllDirections& d, const OrderLayer& layer, double depth) {
    const Eigen::MatrixXd up = order.phase(layer, d.y, d.y, true);
    const Eigen::MatrixXd down = order.phase(layer, d.y, d.y, false);
    Slab slab{up, down, (-depth * d.mu.cwiseInverse().array()).exp()};
    for (Eigen::Index i = 0; i < d.mu.size(); ++i) {
        for (Eigen::Index j = 0; j < d.mu.size(); ++j) {
            // (exp(-t/a) - exp(-t/b)) / (a - b) = exp(-t/b) (1 - exp(-y)) / y * t / (a b), with
            // y = t (1/a - 1/b): no 0/0 at a = b.
            const double a = d.mu[i], b = d.mu[j];
            const double sum = depth * (1 / a + 1 / b), y = depth * (1 / a - 1 / b);
            const double ratio = std::abs(y) < 1e-300 ? 1.0 : -std::expm1(-y) / y;
            slab.R(i, j) *= layer.albedo / (4 * (a + b)) * -std::expm1(-sum);
            slab.T(i, j) *= layer.albedo * depth / (4 * a * b) * std::exp(-depth / b) * ratio;
        }
    }
    return slab;
}

// `top` on something that reflects `below`: downward and upward light at the interface, then what
// comes out (de Haan et al. 1987).
struct Combined {
    Eigen::MatrixXd R, down;
};

Combined put_on(const AllDirections& d, const Slab& top, const Eigen::MatrixXd& below) {
    const auto E = top.E.asDiagonal();
    const Eigen::MatrixXd S = d.repeated(top.R, below);
    Combined c;
    c.down = top.T + S * E + d.star(S, top.T);
    const Eigen::MatrixXd up = below * E + d.star(below, c.down);
    c.R = top.R + E * up + d.star(top.T, up);
    return c;
}

Slab doubled(const AllDirections& d, const Slab& slab) {
    const Combined c = put_on(d, slab, slab.R);
    const auto E = slab.E.asDiagonal();
    return {c.R, E * c.down + slab.T * E + d.star(slab.T, c.down), slab.E.cwiseAbs2()};
}

Slab layer_of(const Order& order, const AllDirections& d, const OrderLayer& layer, double thin) {
    const int doublings =
        std::max(0, static_cast<int>(std::ceil(std::log2(layer.optical_depth / thin))));
    Slab slab = thin_layer(order, d, layer, std::ldexp(layer.optical_depth, -doublings));
    for (int i = 0; i < doublings; ++i) slab = doubled(d, slab);
    return slab;
}

// Stops when doubling adds less than rounding; 80 doublings from 1e-8 are an optical depth of 1e16.
Eigen::MatrixXd half_space(const Order& order, const AllDirections& d, const OrderLayer& layer,
                           double thin) {
    Slab slab = thin_layer(order, d, layer, thin);
    for (int i = 0; i < 80; ++i) {
        Slab next = doubled(d, slab);
        const bool thick = next.E.maxCoeff() < 1e-12;
        const double change = (next.R - slab.R).cwiseAbs().maxCoeff();
        slab = std::move(next);
        if (thick && change <= 1e-14 * slab.R.cwiseAbs().maxCoeff()) break;
    }
    return slab.R;
}

}  // namespace

Eigen::MatrixXd adding_doubling(const Order& order, double thin) {
    const AllDirections d(order);
    Eigen::MatrixXd R = half_space(order, d, order.layers.back(), thin);
    for (std::size_t i = order.layers.size() - 1; i-- > 0;) {
        if (!(order.layers[i].optical_depth > 0)) continue;
        R = put_on(d, layer_of(order, d, order.layers[i], thin), R).R;
    }
    const Eigen::Index u = order.user_mu.size();
    return R.bottomRightCorner(u, u);
}

namespace {

// At albedo 1 an eigenvalue is 0 and its two solutions are the same; the usual cure is a
// little absorption.
constexpr double kLargestAlbedo = 1 - 1e-10;

// Solutions of one layer in its own depth t: with s = up + down and d = up - down,
//     ds/dt = B d - M^-1 (Q+ - Q-) e^(-t/mu0),   dd/dt = A s - M^-1 (Q+ + Q-) e^(-t/mu0),
// homogeneous s = x e^(-kt), d = -A x / k e^(-kt), k^2 x = B A x.
struct LayerSolution {
    Eigen::MatrixXd up, down;  // decaying modes at the nodes; growing ones have them swapped
    Eigen::VectorXd k;
    Eigen::VectorXd beam_up, beam_down;  // particular solution, amplitude at the layer's top
    double depth = 0.0, top = 0.0;
    bool endless = false;

    Eigen::VectorXd decay() const { return (-k.array() * depth).exp(); }
};

LayerSolution solve_layer(const Order& order, const OrderLayer& layer, double mu0,
                          const Eigen::MatrixXd& y0, double top, bool endless) {
    const Eigen::Index n = order.mu.size();
    const double albedo = std::min(layer.albedo, kLargestAlbedo);
    const Eigen::MatrixXd pt = order.phase(layer, order.nodes, order.nodes, false);
    const Eigen::MatrixXd pr = order.phase(layer, order.nodes, order.nodes, true);
    const auto W = order.weights.asDiagonal();
    const Eigen::VectorXd inverse_mu = order.mu.cwiseInverse();
    const Eigen::MatrixXd I = Eigen::MatrixXd::Identity(n, n);
    const Eigen::MatrixXd A = inverse_mu.asDiagonal() * (I - albedo / 2 * (pt + pr) * W);
    const Eigen::MatrixXd B = inverse_mu.asDiagonal() * (I - albedo / 2 * (pt - pr) * W);
    const Eigen::MatrixXd BA = B * A;
    const Eigen::EigenSolver<Eigen::MatrixXd> eigen(BA);
    LayerSolution s;
    s.depth = layer.optical_depth;
    s.top = top;
    s.endless = endless;
    s.k = eigen.eigenvalues().real().cwiseMax(1e-24).cwiseSqrt();
    const Eigen::MatrixXd x = eigen.eigenvectors().real();
    const Eigen::MatrixXd half = A * x * s.k.cwiseInverse().asDiagonal();
    s.up = (x - half) / 2;
    s.down = (x + half) / 2;

    // Beam: s = xs e^(-t/mu0), (B A - 1/mu0^2) xs = B M^-1 Qs - M^-1 Qd / mu0.
    const double strength = albedo / 4 * std::exp(-top / mu0);
    const Eigen::VectorXd q_up = strength * order.phase(layer, order.nodes, y0, true);
    const Eigen::VectorXd q_down = strength * order.phase(layer, order.nodes, y0, false);
    const Eigen::VectorXd qs = inverse_mu.cwiseProduct(q_up + q_down);
    const Eigen::VectorXd qd = inverse_mu.cwiseProduct(q_up - q_down);
    const Eigen::VectorXd xs = (BA - I / (mu0 * mu0)).partialPivLu().solve(B * qs - qd / mu0);
    const Eigen::VectorXd xd = -mu0 * (A * xs - qs);
    s.beam_up = (xs + xd) / 2;
    s.beam_down = (xs - xd) / 2;
    return s;
}

// Amplitudes of all modes: none comes in from the top, radiance is continuous at each interface,
// and nothing grows in the base. Layer i has columns [2 n i, 2 n (i + 1)), decaying modes first.
Eigen::VectorXd amplitudes(const std::vector<LayerSolution>& layers, double mu0) {
    const Eigen::Index n = layers[0].k.size();
    const auto count = static_cast<Eigen::Index>(layers.size());
    const Eigen::Index unknowns = n * (2 * count - 1);
    Eigen::MatrixXd system = Eigen::MatrixXd::Zero(unknowns, unknowns);
    Eigen::VectorXd right(unknowns);
    const auto put_top = [&](Eigen::Index row, const LayerSolution& s, Eigen::Index column, bool up,
                             double sign) {
        system.block(row, column, n, n) = sign * (up ? s.up : s.down);
        if (!s.endless) {
            system.block(row, column + n, n, n) =
                sign * (up ? s.down : s.up) * s.decay().asDiagonal();
        }
    };
    put_top(0, layers[0], 0, false, 1);
    right.head(n) = -layers[0].beam_down;
    for (Eigen::Index i = 0; i + 1 < count; ++i) {
        const LayerSolution& a = layers[static_cast<std::size_t>(i)];
        const LayerSolution& b = layers[static_cast<std::size_t>(i + 1)];
        const Eigen::Index row = n * (2 * i + 1), column = 2 * n * i;
        const double beam = std::exp(-a.depth / mu0);
        for (const bool up : {true, false}) {
            const Eigen::Index r = row + (up ? 0 : n);
            system.block(r, column, n, n) = (up ? a.up : a.down) * a.decay().asDiagonal();
            system.block(r, column + n, n, n) = up ? a.down : a.up;
            put_top(r, b, column + 2 * n, up, -1);
            right.segment(r, n) =
                up ? b.beam_up - beam * a.beam_up : b.beam_down - beam * a.beam_down;
        }
    }
    return system.partialPivLu().solve(right);
}

// (exp(-k h) - exp(-h / mu)) / (1 - k mu), also where k mu = 1. The second form loses digits only
// within 1e-3 of it, and the first one overflows far from it.
double growing_integral(double k, double h, double mu) {
    const double z = h * (1 / mu - k);
    if (std::abs(z) > 1e-3 * h / mu) return (std::exp(-k * h) - std::exp(-h / mu)) / (1 - k * mu);
    const double ratio = z == 0 ? 1.0 : -std::expm1(-z) / z;
    return std::exp(-k * h) * ratio * h / mu;
}

// Radiance that leaves at a user angle: the source function integrated over every layer.
double leaving(const Order& order, const std::vector<LayerSolution>& layers,
               const Eigen::VectorXd& amplitude, double mu0, const Eigen::MatrixXd& y0,
               Eigen::Index user) {
    const Eigen::Index n = order.mu.size();
    const double mu = order.user_mu[user];
    double sum = 0;
    for (std::size_t i = 0; i < layers.size(); ++i) {
        const LayerSolution& s = layers[i];
        const OrderLayer& layer = order.layers[i];
        const double albedo = std::min(layer.albedo, kLargestAlbedo);
        const Eigen::MatrixXd y = order.user.row(user);
        const auto W = order.weights.asDiagonal();
        const Eigen::RowVectorXd same = albedo / 2 * order.phase(layer, y, order.nodes, false) * W;
        const Eigen::RowVectorXd other = albedo / 2 * order.phase(layer, y, order.nodes, true) * W;
        const double h = s.endless ? INFINITY : s.depth;
        double radiance = 0;
        const auto column = static_cast<Eigen::Index>(2 * n * static_cast<Eigen::Index>(i));
        for (Eigen::Index j = 0; j < n; ++j) {
            const double decaying = same.dot(s.up.col(j)) + other.dot(s.down.col(j));
            radiance += amplitude[column + j] * decaying * -std::expm1(-h * (1 / mu + s.k[j])) /
                        (1 + s.k[j] * mu);
            if (s.endless) continue;
            const double growing = same.dot(s.down.col(j)) + other.dot(s.up.col(j));
            radiance += amplitude[column + n + j] * growing * growing_integral(s.k[j], h, mu);
        }
        const double q =
            albedo / 4 * std::exp(-s.top / mu0) * order.phase(layer, y, y0, true)(0, 0);
        const double beam = same.dot(s.beam_up) + other.dot(s.beam_down) + q;
        radiance += beam * -std::expm1(-h * (1 / mu + 1 / mu0)) * mu0 / (mu + mu0);
        sum += std::exp(-s.top / mu) * radiance;
    }
    return sum;
}

}  // namespace

Eigen::MatrixXd discrete_ordinates(const Order& order) {
    const Eigen::Index u = order.user_mu.size();
    Eigen::MatrixXd R(u, order.incident);
    for (Eigen::Index in = 0; in < order.incident; ++in) {
        const double mu0 = order.user_mu[in];
        const Eigen::MatrixXd y0 = order.user.row(in);
        std::vector<LayerSolution> layers;
        double top = 0;
        for (std::size_t i = 0; i < order.layers.size(); ++i) {
            const bool endless = i + 1 == order.layers.size();
            layers.push_back(solve_layer(order, order.layers[i], mu0, y0, top, endless));
            top += endless ? 0 : order.layers[i].optical_depth;
        }
        const Eigen::VectorXd amplitude = amplitudes(layers, mu0);
        for (Eigen::Index out = 0; out < u; ++out) {
            R(out, in) = leaving(order, layers, amplitude, mu0, y0, out) / mu0;
        }
    }
    return R;
}

}  // namespace miebrdf::bench
