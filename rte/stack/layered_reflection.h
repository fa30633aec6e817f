// Beside the public <miebrdf/transfer.h>: tables of the Fourier orders of a solution, solutions
// with and without polarisation.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include <miebrdf/transfer.h>
#include "rte/stack/fourier_sum.h"
#include "rte/stack/scaled_stack.h"

namespace miebrdf::rte {

struct TabulatedOrders {
    ScaledStack stack;  ///< that was solved
    /// R^m of light scattered more than once for m = 0, 1, ... (StackOrder::multiple); rows and
    /// columns are the cosines of the table. Over mirrors a rough boundary adds their lobe.
    FourierOrders orders;
    bool converged = true;
    bool physical = true;  ///< false: orders may be missing
};

class RoughBoundaries;

/// Memory that shares its rough boundaries with other solutions, in this thread or others.
SolutionMemory memory_with(std::shared_ptr<RoughBoundaries> boundaries);

/// Solves a stack between all pairs of cosines with the nodes and moments of an earlier solution.
/// @param solved  its report, by `reflect`
/// @param known   its memory
TabulatedOrders tabulate_orders(const Stack& stack, const std::vector<double>& mu,
                                const SolvedLight& light, const SolverReport& solved,
                                const SolverOptions& options, SolutionMemory& known);

// Validation and results that requests for reflections and for albedos share.

/// @throws UsageError  for cosines outside (0, 1]
void require_cosines(const std::vector<double>& cosines, const char* field);
/// @throws UsageError  for methods and rough boundaries, which polarised light cannot have
void require_polarisable(const Stack& stack, const SolverOptions& options);

/// The stack with each medium's list of moments padded by 0 to the length of its longest list of
/// matrix coefficients: nodes and moments are chosen by the length of the list of moments.
Stack with_all_moments(Stack stack);

/// Reorders [pair][element][azimuth] (FirstOrderSum) as [pair][azimuth][element].
std::vector<double> elements_last(std::vector<double> values, std::size_t elements,
                                  std::size_t azimuths);

/// ReflectionTable::mirror_reflectance, with unscaled optical depths: light in the forward peak is
/// scattered, and belongs to no beam.
/// @param exact         overwritten by the unscaled stack
/// @param reflectances  overwritten
void find_mirror_reflectances(const Stack& stack, const std::vector<double>& mu_in,
                              const SolvedLight& light, ScaledStack& exact,
                              std::vector<double>& reflectances);

/// AlbedoTable::unscattered_transmittance, with unscaled optical depths.
/// @param shares  overwritten
void find_unscattered(const Stack& stack, const std::vector<double>& mu_in, int components,
                      ScaledStack& exact, std::vector<double>& shares);

/// R11, or albedos and transmittances, without polarisation and with it (I, Q, U).
struct LightComparison {
    std::vector<double> without, with;  ///< all NaN where one of the two is not physical
};

/// Solves a stack with and without polarisation, with SolverOptions::streams nodes, for the
/// difference of the two: errors are not estimated, and both lack features that the nodes do not
/// resolve. Values are in the order of ReflectionTable::reflection.
LightComparison compare_light(const Stack& stack, const Directions& directions,
                              const SolverOptions& options, SolutionMemory& memory);
/// The same for plane albedos, the spherical albedo and transmittances.
LightComparison compare_albedos(const Stack& stack, const std::vector<double>& mu_in,
                                const SolverOptions& options, SolutionMemory& memory);

}  // namespace miebrdf::rte
