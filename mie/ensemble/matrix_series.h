// From a scattering matrix at angles to its series in generalised spherical functions.
#pragma once

#include <Eigen/Core>

#include <miebrdf/ensemble.h>
#include "rte/math/quadrature.h"

namespace miebrdf::mie {

/// Coefficients of a1, a4, a2, a3, b1, b2 without their factor 2l + 1, row = degree 0 ... `degree`.
/// @param values  a1, a4, a2 + a3, a2 - a3, b1, b2 at the nodes of the rule, row = node
Eigen::MatrixXd matrix_series(Eigen::MatrixXd values, const math::Quadrature& rule, int degree);

/// The largest difference of two coefficients; a shorter series has zeros beyond its end.
double series_change(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b);

/// Sets moments and coefficients, of which a1_0 becomes 1 and the end that is rounding is cut off.
void put_series(const Eigen::MatrixXd& series, MatrixOptics& matrix);

}  // namespace miebrdf::mie
