#include "rte/math/decay_integrals.h"

#include <boost/math/quadrature/gauss.hpp>
#include <cmath>

namespace miebrdf::math {
namespace {

double sinh_ratio(double y, double u) {  // sinh(y u) / sinh(y)
    return y < 1e-8 ? u : std::sinh(y * u) / std::sinh(y);
}

// Smooth integrands: 15 Gauss nodes integrate exp and sinh of arguments below 1 to rounding.
DecayIntegrals by_quadrature(double x, double y) {
    using rule = boost::math::quadrature::gauss<double, 15>;
    const double near = rule::integrate(
        [=](double u) { return std::exp(-x * u) * sinh_ratio(y, 1.0 - u); }, 0.0, 1.0);
    const double far =
        rule::integrate([=](double u) { return std::exp(-x * u) * sinh_ratio(y, u); }, 0.0, 1.0);
    return {x * near, x * far};
}

// [x sinh y - y cosh y + y e^-x] / (x^2 - y^2) and its mirror: for x well above y.
DecayIntegrals by_difference_of_squares(double x, double y) {
    const double y_coth = y < 1e-8 ? 1.0 : y / std::tanh(y);
    const double y_over_sinh = y < 1e-8 ? 1.0 : y > 700.0 ? 0.0 : y / std::sinh(y);
    const double decay = std::exp(-x);
    const double factor = x / ((x - y) * (x + y));
    return {factor * (x - y_coth + decay * y_over_sinh),
            factor * (y_over_sinh - decay * (x + y_coth))};
}

// (1 - exp(-t)) / t for t >= 0.
double mean_decay(double t) { return t < 1e-8 ? 1.0 - 0.5 * t : -std::expm1(-t) / t; }

// Exponentials apart: for y not small.
DecayIntegrals by_exponentials(double x, double y) {
    const double sum = mean_decay(x + y);
    const double difference = mean_decay(std::abs(x - y));
    const double norm = x / -std::expm1(-2.0 * y);
    const double near = norm * (sum - std::exp(-y - std::min(x, y)) * difference);
    const double far = norm * (std::exp(-std::min(x, y)) * difference - std::exp(-y) * sum);
    return {near, far};
}

}  // namespace

DecayIntegrals decay_integrals(double x, double y) {
    if (x < 1.0 && y < 1.0) return by_quadrature(x, y);
    if (y < 0.5 || x > 2.0 * y + 1.0) return by_difference_of_squares(x, y);
    return by_exponentials(x, y);
}

void decay_integrals(const Eigen::ArrayXd& x, const Eigen::ArrayXd& y, Eigen::MatrixXd& near,
                     Eigen::MatrixXd& far) {
    // The nodes of by_quadrature on (0, 1): symmetric, so sinh(y (1 - u)) is the table of
    // sinh(y u) read backwards.
    using rule = boost::math::quadrature::gauss<double, 15>;
    constexpr int count = 15;
    Eigen::Array<double, count, 1> nodes;
    Eigen::Array<double, count, 1> weights;
    for (int k = 0; k <= count / 2; ++k) {
        const auto at = std::size_t(k);
        nodes[count / 2 + k] = 0.5 + 0.5 * rule::abscissa()[at];
        nodes[count / 2 - k] = 0.5 - 0.5 * rule::abscissa()[at];
        weights[count / 2 + k] = weights[count / 2 - k] = 0.5 * rule::weights()[at];
    }
    Eigen::Array<double, count, Eigen::Dynamic> decay(count, x.size());
    for (Eigen::Index i = 0; i < x.size(); ++i) {
        if (x[i] < 1.0) decay.col(i) = x[i] * weights * (-x[i] * nodes).exp();
    }

    near.resize(x.size(), y.size());
    far.resize(x.size(), y.size());
    for (Eigen::Index j = 0; j < y.size(); ++j) {
        Eigen::Array<double, count, 1> ratio;
        if (y[j] < 1.0) {
            for (int k = 0; k < count; ++k) ratio[k] = sinh_ratio(y[j], nodes[k]);
        }
        for (Eigen::Index i = 0; i < x.size(); ++i) {
            if (x[i] < 1.0 && y[j] < 1.0) {
                near(i, j) = (decay.col(i) * ratio.reverse()).sum();
                far(i, j) = (decay.col(i) * ratio).sum();
            } else {
                const DecayIntegrals integrals = decay_integrals(x[i], y[j]);
                near(i, j) = integrals.near;
                far(i, j) = integrals.far;
            }
        }
    }
}

}  // namespace miebrdf::math
