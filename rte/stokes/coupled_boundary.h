// Smooth boundaries and mirrors of four components: total reflection and metals turn U into V.
#pragma once

#include "rte/stokes/coupled_layer.h"
#include "rte/stokes/polarised_boundary.h"

namespace miebrdf::rte {

/// As mirror_ground, for a block that ends with V.
/// @param nodes, cosines  in the medium above it, once each
/// @param requested       repeated()
void coupled_mirror(double here, std::complex<double> mirror, const ZenithGrid& nodes,
                    const RequestedDirections& cosines, const RequestedDirections& requested,
                    const StokesBlock& block, Reflector& result);

/// As put_boundary_on, for such blocks: nothing is symmetric, and there is no sky.
/// @param requested  repeated(), in the medium below
/// @param parts      `pairs` or `nodes`
void put_boundary_on_coupled(const FresnelReflections& matrices, const StokesBlock& block,
                             const RequestedDirections& requested, ReflectorParts parts,
                             const Reflector& below, Reflector& result);

}  // namespace miebrdf::rte
