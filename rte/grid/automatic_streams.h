// Chooses the number of streams, and says how far off the result may be.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include <miebrdf/solver.h>
#include "rte/grid/discretisation.h"
#include "rte/stack/stack.h"

namespace miebrdf::rte {

/// One solution with one discretisation.
struct Attempt {
    std::vector<double> values;        ///< reflection, or plane albedos and the spherical albedo
    std::vector<double> plane_albedo;  ///< beside a reflection
    SolverReport report;
    bool physical = false;
};

using Solve = std::function<Attempt(const Discretisation&)>;

/// Two numbers of nodes give the result and what its error may be; without a given number of nodes
/// they grow until the estimate meets the tolerance or stops falling. A result that is not physical
/// is `count` times NaN.
///
/// @param block  values of one incidence: errors are relative to the largest of them
Attempt solve_with_estimate(const Stack& stack, const SolverOptions& options, std::size_t count,
                            std::size_t block, const Solve& solve);

}  // namespace miebrdf::rte
