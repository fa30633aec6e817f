// From a scattering matrix at angles to its series in generalised spherical functions.
#pragma once

#include <Eigen/Core>

#include "rte/math/quadrature.h"

namespace miebrdf::math {

/// Coefficients of a1, a4, a2, a3, b1, b2 without their factor 2l + 1, row = degree 0 ... `degree`.
/// @param values  a1, a4, a2 + a3, a2 - a3, b1, b2 at the nodes of the rule, row = node; or a1
///                alone, whose moments alone are the result then
/// @param rule    nodes are cosines in [-1, 1], in any order
Eigen::MatrixXd matrix_series(Eigen::MatrixXd values, const Quadrature& rule, int degree);

}  // namespace miebrdf::math
