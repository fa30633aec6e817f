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
/// 2 count - 1. Zeros by Newton's iteration, weights 2 / ((1 - x^2) P'_n(x)^2).
///
/// @param count  1 to 8192
/// @throws UsageError  for a count out of range, or an interval that is empty or not finite
Quadrature gauss_legendre(int count, double lower = -1.0, double upper = 1.0);

/// Gauss: exact to degree 2 count - 1. Radau: one node is the lowest of the points, exact to degree
/// 2 count - 2.
enum class GaussRule { gauss, radau };

/// The rule of `count` nodes that gives polynomials the sum over all of `points`, from the
/// recurrence of the polynomials that are orthogonal there (Lanczos) and the eigenvalues of its
/// matrix (Golub & Welsch 1969, Math. Comp. 23, 221; Golub 1973, SIAM Rev. 15, 318 for Radau).
///
/// @param points  ascending, weights not negative, several times `count` of them with a weight
/// @param count   2 to 64
/// @throws UsageError  for another count
Quadrature gauss_rule(const Quadrature& points, int count, GaussRule kind = GaussRule::gauss);

}  // namespace miebrdf::math
