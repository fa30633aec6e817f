// A layer whose b2 couples V to U, and the same on something that reflects.
#pragma once

#include "rte/layer/layer.h"
#include "rte/stokes/coupled_half_space.h"

namespace miebrdf::rte {

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

/// As put_on, for reflectors and layers that are not symmetric.
void put_on_coupled(const LayerOperator& layer, const Reflector& base,
                    const RequestedDirections& requested, int rows_per_node, ReflectorParts parts,
                    Reflector& result);

}  // namespace miebrdf::rte
