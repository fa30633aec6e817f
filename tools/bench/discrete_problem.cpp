#include "tools/bench/discrete_problem.h"

#include <algorithm>
#include <cmath>

#include "rte/math/legendre.h"
#include "rte/math/quadrature.h"

namespace miebrdf::bench {
namespace {

// Largest change of R by one more order, relative, at which the sum over orders is ended.
constexpr double kOrderTolerance = 1e-10;

struct Scaled {
    double albedo, optical_depth, cut;  // cut: f, the share of the forward peak
    std::vector<double> chi;
};

Scaled delta_scale(const MomentLayer& layer, int moments) {
    std::vector<double> chi = layer.chi;
    chi.resize(std::size_t(moments) + 1, 0.0);
    const double f = std::max(0.0, chi.back()), a = layer.single_scattering_albedo;
    chi.pop_back();
    for (double& c : chi) c = (c - f) / (1 - f);
    return {(1 - f) * a / (1 - a * f), layer.optical_depth * (1 - a * f), f, std::move(chi)};
}

/// The nodes and user angles of a stack that was scaled.
struct Problem {
    const MomentStack& stack;
    int streams;
    math::Quadrature rule;
    std::vector<Scaled> scaled = {};
    Eigen::VectorXd mu, user;
    Eigen::Index incident;

    Problem(const MomentStack& given, int n, const std::vector<double>& mu_in,
            const std::vector<double>& mu_out)
        : stack(given), streams(n), rule(math::gauss_legendre(n, 0.0, 1.0)) {
        for (const MomentLayer& layer : stack) scaled.push_back(delta_scale(layer, 2 * n));
        mu = Eigen::VectorXd::Map(rule.nodes.data(), n);
        incident = Eigen::Index(mu_in.size());
        const std::vector<double>& out = mu_out.empty() ? rule.nodes : mu_out;
        user.resize(incident + Eigen::Index(out.size()));
        user << Eigen::VectorXd::Map(mu_in.data(), incident),
            Eigen::VectorXd::Map(out.data(), Eigen::Index(out.size()));
    }

    Order order(int m) const {
        Order order{mu, Eigen::VectorXd::Map(rule.weights.data(), streams), {}, user, {}, incident,
                    {}};
        const int degrees = 2 * streams;
        math::legendre_functions(m, degrees, mu, order.nodes);
        math::legendre_functions(m, degrees, user, order.user);
        for (const Scaled& s : scaled) {
            OrderLayer layer{s.albedo, s.optical_depth, Eigen::VectorXd(degrees - m)};
            for (int l = m; l < degrees; ++l)
                layer.strength[l - m] = (2 * l + 1) * s.chi[std::size_t(l)];
            order.layers.push_back(std::move(layer));
        }
        return order;
    }

    /// Exact minus truncated single scattering of all layers.
    double first_order_correction(double mu_in, double mu_out, double x) const {
        double sum = 0, above = 1;
        for (std::size_t i = 0; i < stack.size(); ++i) {
            const Scaled& s = scaled[i];
            const double depth = s.optical_depth * (1 / mu_in + 1 / mu_out);
            const double exact = stack[i].phase(x) / (1 - s.cut);
            sum +=
                above * -std::expm1(-depth) * s.albedo * (exact - math::legendre_series(s.chi, x));
            above *= std::exp(-depth);
        }
        return sum / (4 * (mu_in + mu_out));
    }
};

}  // namespace

double cos_scattering(double mu_in, double mu_out, double azimuth_deg) {
    const double across = std::sqrt((1 - mu_in * mu_in) * (1 - mu_out * mu_out));
    return std::clamp(-mu_in * mu_out + across * std::cos(azimuth_deg * M_PI / 180), -1.0, 1.0);
}

Eigen::MatrixXd Order::phase(const OrderLayer& layer, const Eigen::MatrixXd& a,
                             const Eigen::MatrixXd& b, bool opposite) const {
    Eigen::VectorXd s = layer.strength;
    if (opposite) {
        for (Eigen::Index i = 1; i < s.size(); i += 2) s[i] = -s[i];
    }
    return a * s.asDiagonal() * b.transpose();
}

std::vector<double> sum_orders(const MomentStack& stack, int streams, const rte::Directions& wanted,
                               const OrderSolver& solver) {
    const Problem problem(stack, streams, wanted.mu_in, wanted.mu_out);
    const auto in = problem.incident, out = Eigen::Index(wanted.mu_out.size());
    std::vector<double> table(wanted.mu_in.size() * wanted.mu_out.size() *
                              wanted.azimuth_deg.size());
    // Calls visit(value, incident, outgoing, azimuth).
    const auto for_each = [&](const auto& visit) {
        auto value = table.begin();
        for (Eigen::Index i = 0; i < in; ++i)
            for (Eigen::Index o = 0; o < out; ++o)
                for (const double azimuth : wanted.azimuth_deg) visit(*value++, i, in + o, azimuth);
    };
    for (int m = 0, quiet = 0; m < 2 * streams && quiet < 2; ++m) {
        const Eigen::MatrixXd all = solver(problem.order(m));
        double change = 0;
        for_each([&](double& value, Eigen::Index i, Eigen::Index o, double azimuth) {
            const double r = (m == 0 ? 1 : 2) * all(o, i);
            value += r * std::cos(m * azimuth * M_PI / 180);
            change = std::max(change, std::abs(r) / std::max(std::abs(value), 1e-300));
        });
        quiet = change <= kOrderTolerance ? quiet + 1 : 0;
    }
    for_each([&](double& value, Eigen::Index i, Eigen::Index o, double azimuth) {
        const double mu_in = problem.user[i], mu_out = problem.user[o];
        value +=
            problem.first_order_correction(mu_in, mu_out, cos_scattering(mu_in, mu_out, azimuth));
    });
    return table;
}

std::vector<double> plane_albedo(const MomentStack& stack, int streams,
                                 const std::vector<double>& mu_in, const OrderSolver& solver) {
    const Problem problem(stack, streams, mu_in, {});
    const Order order = problem.order(0);
    const Eigen::VectorXd albedo =
        2 * solver(order).block(problem.incident, 0, streams, problem.incident).transpose() *
        order.weights.cwiseProduct(order.mu);
    return {albedo.begin(), albedo.end()};
}

}  // namespace miebrdf::bench
