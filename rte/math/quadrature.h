// Quadrature rules.
#pragma once

#include <vector>

namespace miebrdf::math {

/// Nodes in ascending order and their weights, for integrals over one interval.
struct Quadrature {
    std::vector<double> nodes;
    std::vector<double> weights;
};

/// Gauss-Legendre rule with `count` nodes on (lower, upper): exact for polynomials of degree
/// 2 count - 1. Zeros from Boost.Math's Newton iteration, weights 2 / ((1 - x^2) P'_n(x)^2).
///
/// @param count  1 to 8192
/// @throws UsageError  for a count out of range, or an interval that is empty or not finite
Quadrature gauss_legendre(int count, double lower = -1.0, double upper = 1.0);

}  // namespace miebrdf::math
