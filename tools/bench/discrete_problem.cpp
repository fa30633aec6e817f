#include "tools/bench/discrete_problem.h"

#include <algorithm>
#include <cmath>

#include "rte/math/quadrature.h"

namespace miebrdf::bench {
namespace {

// Largest change of R by one more order, relative, at which the sum over orders is ended.
constexpr double kOrderTolerance = 1e-10;

Eigen::MatrixXd legendre_table(int m, int degrees, const Eigen::VectorXd& mu) {
    Eigen::MatrixXd y(mu.size(), degrees - m);
    Eigen::ArrayXd start = Eigen::ArrayXd::Ones(mu.size());
    for (int i = 1; i <= m; ++i) {
        start *=
            std::sqrt((2.0 * i - 1) / (2.0 * i)) * ((1 - mu.array()) * (1 + mu.array())).sqrt();
    }
    y.col(0) = start.matrix();
    for (int l = m; l + 1 < degrees; ++l) {
        const double up = std::sqrt((l + 1.0) * (l + 1.0) - double(m) * m);
        const double down = std::sqrt(double(l) * l - double(m) * m);
        y.col(l + 1 - m) = (2 * l + 1) / up * mu.cwiseProduct(y.col(l - m));
        if (l > m) y.col(l + 1 - m) -= down / up * y.col(l - 1 - m);
    }
    return y;
}

struct Scaled {
    double albedo, optical_depth, cut;  // cut: f, the share of the forward peak
    Eigen::VectorXd chi;
};

Scaled delta_scale(const MomentLayer& layer, int moments) {
    const auto chi = [&](int l) {
        return l < static_cast<int>(layer.chi.size()) ? layer.chi[static_cast<std::size_t>(l)]
                                                      : 0.0;
    };
    const double f = std::max(0.0, chi(moments));
    Scaled s;
    s.cut = f;
    s.albedo = (1 - f) * layer.single_scattering_albedo / (1 - layer.single_scattering_albedo * f);
    s.optical_depth = layer.optical_depth * (1 - layer.single_scattering_albedo * f);
    s.chi.resize(moments);
    for (int l = 0; l < moments; ++l) s.chi[l] = (chi(l) - f) / (1 - f);
    return s;
}

double truncated_phase(const Eigen::VectorXd& chi, double x) {
    double sum = 0, before = 1, now = x;
    for (Eigen::Index l = 0; l < chi.size(); ++l) {
        sum += static_cast<double>(2 * l + 1) * chi[l] * before;
        const double next =
            (static_cast<double>(2 * l + 3) * x * now - static_cast<double>(l + 1) * before) /
            static_cast<double>(l + 2);
        before = now;
        now = next;
    }
    return sum;
}

// Exact minus truncated single scattering of all layers.
double first_order_correction(const MomentStack& stack, const std::vector<Scaled>& scaled,
                              double mu_in, double mu_out, double x) {
    const double q = 1 / mu_in + 1 / mu_out;
    double sum = 0, above = 1;
    for (std::size_t i = 0; i < stack.size(); ++i) {
        const Scaled& s = scaled[i];
        const double depth = s.optical_depth * q;
        const double exact = stack[i].phase(x) / (1 - s.cut);
        sum += above * -std::expm1(-depth) * s.albedo * (exact - truncated_phase(s.chi, x));
        above *= std::exp(-depth);
    }
    return sum / (4 * (mu_in + mu_out));
}

Order make_order(int m, int degrees, const math::Quadrature& rule, const Eigen::VectorXd& user,
                 Eigen::Index incident, const std::vector<Scaled>& scaled) {
    Order order;
    order.incident = incident;
    order.m = m;
    const auto n = static_cast<Eigen::Index>(rule.nodes.size());
    order.mu = Eigen::Map<const Eigen::VectorXd>(rule.nodes.data(), n);
    order.weights = Eigen::Map<const Eigen::VectorXd>(rule.weights.data(), n);
    order.nodes = legendre_table(m, degrees, order.mu);
    order.user_mu = user;
    order.user = legendre_table(m, degrees, user);
    for (const Scaled& s : scaled) {
        OrderLayer layer{s.albedo, s.optical_depth, Eigen::VectorXd(degrees - m)};
        for (int l = m; l < degrees; ++l) layer.strength[l - m] = (2 * l + 1) * s.chi[l];
        order.layers.push_back(std::move(layer));
    }
    return order;
}

std::vector<Scaled> delta_scale(const MomentStack& stack, int moments) {
    std::vector<Scaled> scaled;
    for (const MomentLayer& layer : stack) scaled.push_back(delta_scale(layer, moments));
    return scaled;
}

Eigen::VectorXd joined(const std::vector<double>& a, const std::vector<double>& b) {
    Eigen::VectorXd all(static_cast<Eigen::Index>(a.size() + b.size()));
    std::copy(a.begin(), a.end(), all.begin());
    std::copy(b.begin(), b.end(), all.begin() + static_cast<std::ptrdiff_t>(a.size()));
    return all;
}

}  // namespace

Eigen::MatrixXd Order::phase(const OrderLayer& layer, const Eigen::MatrixXd& a,
                             const Eigen::MatrixXd& b, bool opposite) const {
    Eigen::VectorXd s = layer.strength;
    if (opposite) {
        for (Eigen::Index i = 1; i < s.size(); i += 2) s[i] = -s[i];
    }
    return a * s.asDiagonal() * b.transpose();
}

std::vector<double> sum_orders(const MomentStack& stack, int streams,
                               const std::vector<double>& mu_in, const std::vector<double>& mu_out,
                               const std::vector<double>& azimuth_deg, const OrderSolver& solver) {
    const int degrees = 2 * streams;
    const auto rule = math::gauss_legendre(streams, 0.0, 1.0);
    const auto scaled = delta_scale(stack, degrees);
    const Eigen::VectorXd user = joined(mu_in, mu_out);
    const auto in = static_cast<Eigen::Index>(mu_in.size());
    const auto out = static_cast<Eigen::Index>(mu_out.size());
    std::vector<double> table(mu_in.size() * mu_out.size() * azimuth_deg.size(), 0.0);
    int quiet = 0;
    for (int m = 0; m < degrees && quiet < 2; ++m) {
        const Eigen::MatrixXd all = solver(make_order(m, degrees, rule, user, in, scaled));
        double change = 0;
        std::size_t at = 0;
        for (Eigen::Index i = 0; i < in; ++i) {
            for (Eigen::Index o = 0; o < out; ++o) {
                const double r = (m == 0 ? 1 : 2) * all(in + o, i);
                for (const double azimuth : azimuth_deg) {
                    table[at] += r * std::cos(m * azimuth * M_PI / 180);
                    change = std::max(change, std::abs(r) / std::max(std::abs(table[at]), 1e-300));
                    ++at;
                }
            }
        }
        quiet = change <= kOrderTolerance ? quiet + 1 : 0;
    }
    std::size_t at = 0;
    for (const double i : mu_in) {
        for (const double o : mu_out) {
            for (const double azimuth : azimuth_deg) {
                const double x =
                    -i * o + std::sqrt((1 - i * i) * (1 - o * o)) * std::cos(azimuth * M_PI / 180);
                table[at++] +=
                    first_order_correction(stack, scaled, i, o, std::clamp(x, -1.0, 1.0));
            }
        }
    }
    return table;
}

std::vector<double> plane_albedo(const MomentStack& stack, int streams,
                                 const std::vector<double>& mu_in, const OrderSolver& solver) {
    const int degrees = 2 * streams;
    const auto rule = math::gauss_legendre(streams, 0.0, 1.0);
    const auto scaled = delta_scale(stack, degrees);
    const Eigen::VectorXd user = joined(mu_in, rule.nodes);
    const auto in = static_cast<Eigen::Index>(mu_in.size());
    const Eigen::MatrixXd all = solver(make_order(0, degrees, rule, user, in, scaled));
    std::vector<double> albedo;
    for (Eigen::Index i = 0; i < in; ++i) {
        double sum = 0;
        for (int q = 0; q < streams; ++q) {
            const auto j = static_cast<std::size_t>(q);
            sum += 2 * rule.weights[j] * rule.nodes[j] * all(in + q, i);
        }
        albedo.push_back(sum);
    }
    return albedo;
}

}  // namespace miebrdf::bench
