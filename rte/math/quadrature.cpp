#include "rte/math/quadrature.h"

#include <fmt/format.h>

#include <boost/math/special_functions/legendre.hpp>
#include <cmath>

#include <miebrdf/error.h>

namespace miebrdf::math {

Quadrature gauss_legendre(int count, double lower, double upper) {
    if (!(count >= 1 && count <= 8192)) {
        throw UsageError("count", count, "1 to 8192");
    }
    if (!(lower < upper && std::isfinite(upper - lower))) {
        throw UsageError("interval", fmt::format("({}, {})", lower, upper), "finite, not empty");
    }
    const double centre = 0.5 * (lower + upper);
    const double half_width = 0.5 * (upper - lower);
    // Boost gives the zeros that are not negative, ascending; the rest follow by symmetry.
    const std::vector<double> zeros = boost::math::legendre_p_zeros<double>(count);

    Quadrature rule;
    rule.nodes.resize(count);
    rule.weights.resize(count);
    for (std::size_t i = 0; i < zeros.size(); ++i) {
        const double x = zeros[i];
        const double slope = boost::math::legendre_p_prime(count, x);
        const double weight = 2.0 / ((1.0 - x) * (1.0 + x) * slope * slope);
        const std::size_t above = count - zeros.size() + i;
        const std::size_t below = count - 1 - above;
        rule.nodes[above] = centre + half_width * x;
        rule.nodes[below] = centre - half_width * x;
        rule.weights[above] = rule.weights[below] = half_width * weight;
    }
    return rule;
}

}  // namespace miebrdf::math
