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

}  // namespace miebrdf::math
