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

// Directions of an order: nodes first, then user angles, which carry no weight.
struct Directions {
    Eigen::VectorXd mu, measure;  // measure: 2 mu w
    Eigen::MatrixXd y;

    explicit Directions(const Order& order) {
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

Slab thin_layer(const Order& order, const Directions& d, const OrderLayer& layer, double depth) {
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

Combined put_on(const Directions& d, const Slab& top, const Eigen::MatrixXd& below) {
    const auto E = top.E.asDiagonal();
    const Eigen::MatrixXd S = d.repeated(top.R, below);
    Combined c;
    c.down = top.T + S * E + d.star(S, top.T);
    const Eigen::MatrixXd up = below * E + d.star(below, c.down);
    c.R = top.R + E * up + d.star(top.T, up);
    return c;
}

Slab doubled(const Directions& d, const Slab& slab) {
    const Combined c = put_on(d, slab, slab.R);
    const auto E = slab.E.asDiagonal();
    return {c.R, E * c.down + slab.T * E + d.star(slab.T, c.down), slab.E.cwiseAbs2()};
}

Slab layer_of(const Order& order, const Directions& d, const OrderLayer& layer, double thin) {
    const int doublings =
        std::max(0, static_cast<int>(std::ceil(std::log2(layer.optical_depth / thin))));
    Slab slab = thin_layer(order, d, layer, std::ldexp(layer.optical_depth, -doublings));
    for (int i = 0; i < doublings; ++i) slab = doubled(d, slab);
    return slab;
}

// Stops when doubling adds less than rounding; 80 doublings from 1e-8 are an optical depth of 1e16.
Eigen::MatrixXd half_space(const Order& order, const Directions& d, const OrderLayer& layer,
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
    const Directions d(order);
    Eigen::MatrixXd R = half_space(order, d, order.layers.back(), thin);
    for (std::size_t i = order.layers.size() - 1; i-- > 0;) {
        if (!(order.layers[i].optical_depth > 0)) continue;
        R = put_on(d, layer_of(order, d, order.layers[i], thin), R).R;
    }
    const Eigen::Index u = order.user_mu.size();
    return R.bottomRightCorner(u, u);
}

}  // namespace miebrdf::bench
