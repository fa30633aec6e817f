// Wigner's functions d^l_mn: what Legendre functions are to numbers, they are to polarised light.
#pragma once

#include <Eigen/Core>
#include <span>

#include "rte/math/matrices.h"

namespace miebrdf::math {

/// d^l_mn(theta) as a function of the cosine, with the signs of Mishchenko, Travis & Lacis
/// (Scattering, Absorption, and Emission of Light by Small Particles, 2002, appendix B): d^l_00 =
/// P_l, (-1)^m d^l_m0 = Y_l^m of legendre.h, d^2_02 = sqrt(6)/4 sin^2, d^l_mn = (-1)^(m-n) d^l_nm.
///
/// Upward recurrence in l from l = max(|m|, |n|), stable on [-1, 1]:
/// l r(l+1) d^(l+1) = (2l+1) (l (l+1) x - m n) d^l - (l+1) r(l) d^(l-1),
/// r(l)^2 = (l^2 - m^2) (l^2 - n^2).
///
/// @param m, n     any, of either sign
/// @param degrees  L: columns are l = max(|m|, |n|) ... L - 1; none if there are no such l
/// @param cosine   in [-1, 1]
/// @param table    resized; row = cosine, column = l - max(|m|, |n|)
void wigner_functions(int m, int n, int degrees, const Eigen::Ref<const Eigen::VectorXd>& cosine,
                      Eigen::MatrixXd& table);

/// sum_l c_l d^l_mn(x).
/// @param coefficients  c_0, c_1, ...: those below max(|m|, |n|) are not looked at
/// @param x             in [-1, 1]
double wigner_series(int m, int n, std::span<const double> coefficients, double x);

}  // namespace miebrdf::math
