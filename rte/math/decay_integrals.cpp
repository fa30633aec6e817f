#include "rte/math/decay_integrals.h"

#include <boost/math/quadrature/gauss.hpp>
#include <cmath>
#include <vector>

namespace miebrdf::math {
namespace {

constexpr int node_count = 15;
using NodeArray = Eigen::Array<double, node_count, 1>;

// Smooth integrands: 15 Gauss nodes integrate exp and sinh of arguments below 1 to rounding.
struct UnitInterval {
    NodeArray nodes, weights;

    UnitInterval() {
        using rule = boost::math::quadrature::gauss<double, node_count>;
        for (int k = 0; k <= node_count / 2; ++k) {
            const auto at = std::size_t(k);
            nodes[node_count / 2 + k] = 0.5 + 0.5 * rule::abscissa()[at];
            nodes[node_count / 2 - k] = 0.5 - 0.5 * rule::abscissa()[at];
            weights[node_count / 2 + k] = weights[node_count / 2 - k] = 0.5 * rule::weights()[at];
        }
    }
};

const UnitInterval& unit_interval() {
    static const UnitInterval interval;
    return interval;
}

// All that one x needs of exp, computed once for every y.
struct Decay {
    double x, exp_minus_x;
    NodeArray weighted;  // x w exp(-x u), for x < 1

    explicit Decay(double x_) : x(x_), exp_minus_x(std::exp(-x_)) {
        const UnitInterval& unit = unit_interval();
        if (x < 1.0) weighted = x * unit.weights * (-x * unit.nodes).exp();
    }
};

// All that one y needs of exp, sinh and coth.
struct Rate {
    double y, exp_minus_y, y_coth, y_over_sinh, inverse_norm;
    NodeArray ratio;  // sinh(y u) / sinh(y), for y < 1

    explicit Rate(double y_) : y(y_), exp_minus_y(std::exp(-y_)) {
        y_coth = y < 1e-8 ? 1.0 : y / std::tanh(y);
        y_over_sinh = y < 1e-8 ? 1.0 : y > 700.0 ? 0.0 : y / std::sinh(y);
        inverse_norm = -1.0 / std::expm1(-2.0 * y);  // not used for small y
        if (!(y < 1.0)) return;
        for (int k = 0; k < node_count; ++k) {
            const double u = unit_interval().nodes[k];
            ratio[k] = y < 1e-8 ? u : std::sinh(y * u) / std::sinh(y);
        }
    }
};

// The nodes are symmetric: sinh(y (1 - u)) is the table of sinh(y u) read backwards.
DecayIntegrals by_quadrature(const Decay& a, const Rate& b) {
    return {(a.weighted * b.ratio.reverse()).sum(), (a.weighted * b.ratio).sum()};
}

// [x sinh y - y cosh y + y e^-x] / (x^2 - y^2) and its mirror: for x well above y.
DecayIntegrals by_difference_of_squares(const Decay& a, const Rate& b) {
    const double factor = a.x / ((a.x - b.y) * (a.x + b.y));
    return {factor * (a.x - b.y_coth + a.exp_minus_x * b.y_over_sinh),
            factor * (b.y_over_sinh - a.exp_minus_x * (a.x + b.y_coth))};
}

// (e^-y - e^-x) / (x - y), which is e^-y where both are equal.
double mean_between(const Decay& a, const Rate& b) {
    const double distance = a.x - b.y;
    if (std::abs(distance) > 0.5) return (b.exp_minus_y - a.exp_minus_x) / distance;
    const double ratio =
        std::abs(distance) < 1e-8 ? 1.0 - 0.5 * distance : -std::expm1(-distance) / distance;
    return b.exp_minus_y * ratio;
}

// Exponentials apart: for y not small.
DecayIntegrals by_exponentials(const Decay& a, const Rate& b) {
    const double sum = (1.0 - a.exp_minus_x * b.exp_minus_y) / (a.x + b.y);
    const double difference = mean_between(a, b);
    const double norm = a.x * b.inverse_norm;
    return {norm * (sum - b.exp_minus_y * difference), norm * (difference - b.exp_minus_y * sum)};
}

DecayIntegrals integrate(const Decay& a, const Rate& b) {
    if (a.x < 1.0 && b.y < 1.0) return by_quadrature(a, b);
    if (b.y < 0.5 || a.x > 2.0 * b.y + 1.0) return by_difference_of_squares(a, b);
    return by_exponentials(a, b);
}

}  // namespace

DecayIntegrals decay_integrals(double x, double y) { return integrate(Decay(x), Rate(y)); }

void decay_integrals(const Eigen::ArrayXd& x, const Eigen::ArrayXd& y, Eigen::MatrixXd& near,
                     Eigen::MatrixXd& far) {
    std::vector<Decay> decays;
    decays.reserve(std::size_t(x.size()));
    for (const double value : x) decays.emplace_back(value);
    near.resize(x.size(), y.size());
    far.resize(x.size(), y.size());
    for (Eigen::Index j = 0; j < y.size(); ++j) {
        const Rate rate(y[j]);
        for (Eigen::Index i = 0; i < x.size(); ++i) {
            const DecayIntegrals integrals = integrate(decays[std::size_t(i)], rate);
            near(i, j) = integrals.near;
            far(i, j) = integrals.far;
        }
    }
}

}  // namespace miebrdf::math
