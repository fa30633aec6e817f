#include "rte/math/decay_integrals.h"

#include <boost/math/quadrature/gauss.hpp>
#include <cmath>
#include <vector>

namespace miebrdf::math {
namespace {

using NodeArray = DecayIntegrator::NodeArray;
constexpr int kNodeCount = NodeArray::RowsAtCompileTime;

// Smooth integrands: 15 Gauss nodes integrate exp and sinh of arguments below 1 to rounding.
struct UnitInterval {
    NodeArray nodes, weights;

    UnitInterval() {
        using rule = boost::math::quadrature::gauss<double, kNodeCount>;
        for (int k = 0; k <= kNodeCount / 2; ++k) {
            const auto at = std::size_t(k);
            nodes[kNodeCount / 2 + k] = 0.5 + 0.5 * rule::abscissa()[at];
            nodes[kNodeCount / 2 - k] = 0.5 - 0.5 * rule::abscissa()[at];
            weights[kNodeCount / 2 + k] = weights[kNodeCount / 2 - k] = 0.5 * rule::weights()[at];
        }
    }
};

const UnitInterval& unit_interval() {
    static const UnitInterval interval;
    return interval;
}

using Decay = DecayIntegrator::Decay;

// sinh(z) / z for |z| <= 1: the first term left out is z^18 / 19! = 8e-18.
template <typename Number>
Number sinh_over(const Number& z) {
    const Number z2 = z * z;
    Number sum = 1.0 + z2 / 272.0;
    for (const double divisor : {210.0, 156.0, 110.0, 72.0, 42.0, 20.0, 6.0}) {
        sum = 1.0 + z2 / divisor * sum;
    }
    return sum;
}

// All that one y needs of exp, sinh and coth.
struct Rate {
    double y, exp_minus_y, y_coth, y_over_sinh, inverse_norm;
    NodeArray ratio;  // sinh(y u) / sinh(y), for y < 1

    explicit Rate(double y_) : y(y_), exp_minus_y(std::exp(-y_)) {
        y_coth = y < 1e-8 ? 1.0 : y / std::tanh(y);
        y_over_sinh = y < 1e-8 ? 1.0 : y > 700.0 ? 0.0 : y / std::sinh(y);
        inverse_norm = -1.0 / std::expm1(-2.0 * y);  // not used for small y
        if (!(y < 1.0)) return;
        const NodeArray& u = unit_interval().nodes;
        ratio = u * sinh_over<NodeArray>(y * u) / sinh_over(y);
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

DecayIntegrator::Decay::Decay(double x_) : x(x_), exp_minus_x(std::exp(-x_)) {
    const UnitInterval& unit = unit_interval();
    if (x < 1.0) weighted = x * unit.weights * (-x * unit.nodes).exp();
}

void DecayIntegrator::set(double optical_depth, const Eigen::VectorXd& mu) {
    const auto is_known = [&] {
        if (Eigen::Index(decays_.size()) != mu.size()) return false;
        for (Eigen::Index i = 0; i < mu.size(); ++i) {
            if (decays_[std::size_t(i)].x != optical_depth / mu[i]) return false;
        }
        return true;
    };
    if (is_known()) return;
    decays_.clear();
    for (const double cosine : mu) decays_.emplace_back(optical_depth / cosine);
}

void DecayIntegrator::integrate(double y, Eigen::Ref<Eigen::VectorXd> near,
                                Eigen::Ref<Eigen::VectorXd> far) const {
    const Rate rate(y);
    for (std::size_t i = 0; i < decays_.size(); ++i) {
        const DecayIntegrals integrals = math::integrate(decays_[i], rate);
        near[Eigen::Index(i)] = integrals.near;
        far[Eigen::Index(i)] = integrals.far;
    }
}

}  // namespace miebrdf::math
