// A layer whose b2 couples V to U, and the same on something that reflects.
#pragma once

#include <vector>

#include "rte/layer/layer.h"
#include "rte/stokes/coupled_half_space.h"

namespace miebrdf::rte {

/// Mueller matrices, one for each node or cosine, as they act on rows of Stokes vectors that end
/// with U and V: each row times `diagonal`, and of U and V the other row times `twist`, which has
/// opposite signs in both. They commute.
struct TwistedRows {
    Eigen::VectorXd diagonal, twist;

    Eigen::MatrixXd times(const Eigen::MatrixXd& rows, int rows_per_node) const;
    TwistedRows following(const TwistedRows& other, int rows_per_node) const;
    Eigen::MatrixXd of_node(Eigen::Index node, int rows_per_node) const;
};

/// Reflector::specular and its twist; zeros without.
TwistedRows specular_of(const Reflector& reflector, Eigen::Index rows);

/// What arrives at the nodes of light at some of the requested cosines, columns, from what leaves
/// from the nodes there, rows: J rows^T J.
Eigen::MatrixXd arriving(const Eigen::MatrixXd& rows, const std::vector<int>& which,
                         int rows_per_node);

/// As solve_layer, out of the complex eigenmodes of CoupledModes::rates: Z_p = Z tanh(A tau/2), Z_m
/// = Z coth(A tau/2). About 30 times the work of the symmetric equations.
/// @param layer  reflection, transmission, rows, `multiple` and `direct`; as X, not symmetric
/// Arguments as of solve_coupled_half_space.
void solve_coupled_layer(double scaled_optical_depth, const StokesTables& tables,
                         const StokesBlock& block, const MatrixStrengths& strengths,
                         const FourierMode& mode, const FourierMedium& medium,
                         const ZenithGrid& nodes, const RequestedDirections& cosines,
                         const RequestedDirections& requested, double tolerance, CoupledWork& work,
                         LayerOperator& layer);

/// As put_on, for reflectors and layers that are not symmetric, without sky and glow.
void put_on_coupled(const LayerOperator& layer, const Reflector& base,
                    const RequestedDirections& requested, int rows_per_node, ReflectorParts parts,
                    Reflector& result);

}  // namespace miebrdf::rte
