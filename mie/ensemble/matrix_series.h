// From a scattering matrix at angles to its series in generalised spherical functions.
#pragma once

#include <Eigen/Core>

#include <miebrdf/ensemble.h>
#include "rte/math/quadrature.h"

namespace miebrdf::mie {

/// Coefficients of a1, a4, a2 + a3, a2 - a3, b1, b2, row = degree 0 ... `degree`.
/// @param values  the same functions at the nodes of the rule, row = node
Eigen::MatrixXd matrix_series(Eigen::MatrixXd values, const math::Quadrature& rule, int degree);

MatrixExpansion expansion_of(const Eigen::MatrixXd& series);

/// The largest difference of two coefficients, without 2l + 1. Neither is shorter.
double largest_change(const MatrixExpansion& a, const MatrixExpansion& b);

/// Cuts off the end that is rounding.
void trim(MatrixExpansion& expansion);

}  // namespace miebrdf::mie
