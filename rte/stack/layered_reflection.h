// <miebrdf/transfer.h>, and tables of the Fourier orders of a solution.
#pragma once

#include <cstddef>
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

/// Solves a stack with the nodes and moments of a solution that is known (`reflect`).
/// @param mu  cosines, of incidence and of reflection
TabulatedOrders tabulate_orders(const Stack& stack, const std::vector<double>& mu,
                                const SolvedLight& light, const SolverReport& solved,
                                const SolverOptions& options);

/// ReflectionTable::mirror_reflectance. Nothing scattered is taken for a beam here: with the
/// optical depths as they are.
/// @param exact  overwritten; its memory is used again
void find_mirror_reflectances(const Stack& stack, const std::vector<double>& mu_in,
                              const SolvedLight& light, ScaledStack& exact,
                              std::vector<double>& reflectances);

/// [pair][element][azimuth], as FirstOrderSum has them, to [pair][azimuth][element].
std::vector<double> elements_last(std::vector<double> values, std::size_t elements,
                                  std::size_t azimuths);

/// The stack with as many moments as the longest list of its media's coefficients, so that whatever
/// chooses by the number of moments sees them all.
Stack with_all_moments(Stack stack);

}  // namespace miebrdf::rte
