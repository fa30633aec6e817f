// <miebrdf/transfer.h>, and tables of the Fourier orders of a solution.
#pragma once

#include <memory>
#include <vector>

#include <miebrdf/transfer.h>
#include "rte/stack/fourier_sum.h"
#include "rte/stack/scaled_stack.h"

namespace miebrdf::rte {

struct TabulatedOrders {
    ScaledStack stack;  ///< as it was solved
    /// R^m for m = 0, 1, ... of light scattered more than once: StackOrder::multiple, rows and
    /// columns the cosines of the table. Below a rough boundary with the lobe that mirrors send
    /// back through it.
    FourierOrders orders;
    bool converged = true;
    bool physical = true;  ///< false: there may be no orders
};

class RoughBoundaries;

/// Memory whose rough boundaries are those of several solutions, at the same time or not.
SolutionMemory memory_with(std::shared_ptr<RoughBoundaries> boundaries);

/// Solves a stack with the nodes and moments of a solution that is known (`reflect`).
/// @param mu     cosines, of incidence and of reflection
/// @param known  of that solution
TabulatedOrders tabulate_orders(const Stack& stack, const std::vector<double>& mu,
                                const SolvedLight& light, const SolverReport& solved,
                                const SolverOptions& options, SolutionMemory& known);

/// R11, or albedos and transmittances, of light as a number and of (I, Q, U).
struct LightComparison {
    std::vector<double> without, with;  ///< polarisation; all NaN: one of them is not physical
};

/// Solves a stack twice with SolverOptions::streams nodes, for the difference of the two: how far
/// they are off themselves is not estimated, and features that so few nodes do not resolve are
/// left out of both. `with` and `without` are laid out as ReflectionTable::reflection.
LightComparison compare_light(const Stack& stack, const Directions& directions,
                              const SolverOptions& options, SolutionMemory& memory);
/// Likewise, plane albedos, the spherical albedo and transmittances.
LightComparison compare_albedos(const Stack& stack, const std::vector<double>& mu_in,
                                const SolverOptions& options, SolutionMemory& memory);

}  // namespace miebrdf::rte
