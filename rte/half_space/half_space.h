// Reflection by a semi-infinite homogeneous medium: the base of a BRDF.
// Symbols, signs and normalisation: docs/conventions.md.
#pragma once

#include <miebrdf/solver.h>
#include "rte/fourier/order_work.h"
#include "rte/grid/zenith_grid.h"
#include "rte/half_space/reflector.h"
#include "rte/phase/phase_mode.h"
#include "rte/phase/scattering_mode.h"

namespace miebrdf::rte {

/// Solves Ambartsumian's equation (Chen et al. 2013, eq. 3) for one azimuthal order.
///
/// `automatic`: in closed form. The equation is a symmetric algebraic Riccati equation whose
/// physical solution is a matrix geometric mean: with the matrices of transfer_modes.h,
/// Z = F k F^T solves Z V Z = U, and X = 2 (I + Z)^-1 - I; then one application of eq. (3) removes
/// the rounding at grazing nodes. About 19 n^3 operations, exact at albedo 1. High orders, where a
/// few sweeps of the fixed point reach the tolerance, are solved by these instead.
/// `fixed_point`: the paper's iteration from single scattering; the number of steps grows without
/// bound as the albedo tends to 1.
/// `doubling`: structured doubling from a thin layer, quadratically convergent; independent of any
/// eigenproblem.
///
/// @param tolerance  of the iterative methods: remaining error of (mu + mu') R, relative
/// Not converging is an outcome: read `converged` and `physical`.
/// @param work  matrices that one order after the other can use: nothing is allocated but for the
///              first (`fixed_point` and `doubling` do)
/// @param result  overwritten
void solve_half_space(HalfSpaceMethod method, const ScatteringMode& medium, const PhaseMode& mode,
                      const ZenithGrid& grid, const RequestedDirections& requested,
                      double tolerance, OrderWork& work, Reflector& result);
Reflector solve_half_space(HalfSpaceMethod method, const ScatteringMode& medium,
                           const PhaseMode& mode, const ZenithGrid& grid,
                           const RequestedDirections& requested, double tolerance = 1e-12);

/// True where the fixed point converges in so few steps that it is cheaper than an eigenproblem:
/// high azimuthal orders, whose remaining moments are small.
bool few_sweeps_suffice(const ScatteringMode& medium, double tolerance);

/// The fixed point at nodes and requested cosines at once, without any linear system; for orders
/// of which few_sweeps_suffice. Fills nodes, rows, iterations, residual, converged, physical.
void sweep_half_space(const PhaseMode& mode, const ZenithGrid& grid,
                      const RequestedDirections& requested, double tolerance, OrderWork& work,
                      Reflector& result);

/// X by the paper's fixed-point iteration; fills nodes, iterations, residual, converged, physical.
Reflector iterate_half_space(const ScatteringMode& medium, const PhaseMode& mode,
                             const ZenithGrid& grid, double tolerance);

/// X by structured doubling; fills the same.
Reflector double_to_half_space(const ScatteringMode& medium, const PhaseMode& mode,
                               const ZenithGrid& grid, double tolerance);

}  // namespace miebrdf::rte
