// The series of the scattering matrix of spheres from sums over their sizes.
#pragma once

#include <Eigen/Core>

#include "rte/math/quadrature.h"

namespace miebrdf::mie {

/// Nodes that are exact for the product of two amplitudes and a function of that degree.
int matrix_nodes(int terms, int degree);

/// matrix_series of spheres.
/// @param products   AngularFunctions::add_products at the nodes, with the weights of `scattered`
/// @param scattered  SphereSums::scattered
Eigen::MatrixXd matrix_series_of(const Eigen::ArrayXXd& products, double scattered,
                                 const math::Quadrature& rule, int degree);

}  // namespace miebrdf::mie
