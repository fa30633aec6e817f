// Scattering by spheroids of one size in random orientation.
#pragma once

#include <Eigen/Core>

#include "mie/spheroid/t_matrix.h"

namespace miebrdf::mie {

/// Rows: a1, a4, a2 + a3, a2 - a3, b1, b2 at each cosine of the scattering angle, times the square
/// of the size parameter and q_sca (the mean of the first column over the sphere).
///
/// Amplitudes of light of either helicity, incident along the z axis, with the axis of the particle
/// at the polar angle beta: a sum over Wigner's functions of beta and of the scattering angle.
/// Azimuths of the axis are averaged by orthogonality, and beta by a Gauss rule that is exact for
/// all products of two amplitudes; orientations beta and 180 - beta are one.
///
/// Cost: some 10 degree^4 multiply-adds.
/// @param cosines  of the scattering angle, in [-1, 1]
Eigen::MatrixXd orientation_average(const TMatrix& T, const Eigen::VectorXd& cosines);

}  // namespace miebrdf::mie
