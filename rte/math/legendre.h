// Legendre functions in the normalisation that the addition theorem wants.
#pragma once

#include <Eigen/Core>
#include <span>

#include "rte/math/matrices.h"

namespace miebrdf::math {

/// Renormalised associated Legendre functions Y_l^m = sqrt((l-m)!/(l+m)!) P_l^m without the
/// Condon-Shortley sign, so that P_l(cos Theta) = sum_m (2 - delta_m0) Y_l^m(a) Y_l^m(b) cos(m phi)
/// and |Y_l^m| <= 1: no factorials, no overflow at any degree.
///
/// Upward recurrence in l, stable on [-1, 1]:
/// sqrt((l+1)^2 - m^2) Y_{l+1} = (2l+1) mu Y_l - sqrt(l^2 - m^2) Y_{l-1}.
///
/// @param order    m >= 0
/// @param degrees  L > m: columns are l = m ... L - 1
/// @param mu       cosines in [-1, 1]
/// @param table    resized to mu.size() x (L - m), row = cosine, column = l - m
/// @throws UsageError  for an order or a number of degrees out of range
void legendre_functions(int order, int degrees, const Eigen::Ref<const Eigen::VectorXd>& mu,
                        Eigen::MatrixXd& table);

/// Sums of Legendre polynomials, sum_l weights(j, l) P_l(x_i), by upward recurrence: several
/// functions of many arguments, in registers. Neighbouring functions of few degrees (zeros from
/// there on) take as much less time.
/// @param weights  row j = function, column = degree l = 0, 1, ...
/// @param x        in [-1, 1]
/// @return row = argument, column = function
Eigen::MatrixXd legendre_sums(const Eigen::MatrixXd& weights, const Eigen::VectorXd& x);

/// sum_l (2l+1) chi_l P_l(x) by Clenshaw's downward recurrence.
/// @param chi  chi_0, chi_1, ...; may be empty
/// @param x    in [-1, 1]
double legendre_series(std::span<const double> chi, double x);

}  // namespace miebrdf::math
