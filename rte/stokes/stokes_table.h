// Polarised light scattered more than once, solved once for a table of cosines: what a BRDF table
// is made of.
#pragma once

#include <vector>

#include <miebrdf/optics.h>
#include <miebrdf/solver.h>
#include "rte/stack/fourier_sum.h"
#include "rte/stack/stack_solver.h"

namespace miebrdf::rte {

struct TabulatedStokes {
    ScaledStack stack;  ///< as it was solved
    /// R^m for m = 0, 1, ... of light scattered more than once: StokesOrder::multiple, rows and
    /// columns the cosines of the table.
    FourierOrders orders;
    bool converged = true;
    bool physical = true;  ///< false: there may be no orders
};

/// Solves a stack with the nodes and moments of a solution that is known (reflect_polarised).
/// @param mu          cosines, of incidence and of reflection
/// @param components  3 or 4
TabulatedStokes tabulate_polarised(const Stack& stack, const std::vector<double>& mu,
                                   int components, const SolverReport& solved,
                                   const SolverOptions& options);

}  // namespace miebrdf::rte
