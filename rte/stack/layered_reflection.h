// Private parts of <miebrdf/transfer.h>: tables of the Fourier orders of a solution, and solutions
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

class KeptLayers;
class RoughBoundaries;

/// A memory that shares its rough boundaries and the layers below the topmost one with other
/// solutions, in this thread or others.
/// @param layers  null: these are not kept
SolutionMemory memory_with(std::shared_ptr<RoughBoundaries> boundaries,
                           std::shared_ptr<KeptLayers> layers);

/// Solves a stack between all pairs of cosines with the nodes and moments of an earlier solution.
/// @param solved  its report, by `reflect`
/// @param known   its memory
TabulatedOrders tabulate_orders(const Stack& stack, const std::vector<double>& mu,
                                const SolvedLight& light, const SolverReport& solved,
                                const SolverOptions& options, SolutionMemory& known);

// What reflections, albedos and derivatives have in common (requests.cpp).

/// @throws UsageError  for cosines outside (0, 1]
void require_cosines(const std::vector<double>& cosines, const char* field);
/// @throws UsageError  for methods other than the automatic ones, and for rough boundaries
void require_polarisable(const Stack& stack, const SolverOptions& options);

/// The stack with the moments of each medium padded by 0 to the length of its longest list of
/// matrix coefficients, because nodes and moments are chosen by the length of the list of moments.
Stack with_all_moments(Stack stack);

/// Reorders [pair][element][azimuth] (FirstOrderSum) as [pair][azimuth][element].
std::vector<double> elements_last(std::vector<double> values, std::size_t elements,
                                  std::size_t azimuths);

/// ReflectionTable::mirror_reflectance, by unscaled optical depths, because light in the forward
/// peak is scattered and belongs to no beam.
/// @param exact         overwritten by the unscaled stack
/// @param reflectances  overwritten
void find_mirror_reflectances(const Stack& stack, const std::vector<double>& mu_in,
                              const SolvedLight& light, ScaledStack& exact,
                              std::vector<double>& reflectances);

/// AlbedoTable::unscattered_transmittance, by unscaled optical depths.
/// @param shares  overwritten
void find_unscattered(const Stack& stack, const std::vector<double>& mu_in, int components,
                      ScaledStack& exact, std::vector<double>& shares);

/// R11, or albedos and transmittances, without polarisation and with it (I, Q, U).
struct LightComparison {
    std::vector<double> without, with;  ///< all NaN where one of the two is not physical
};

/// Solves a stack with and without polarisation, with SolverOptions::streams nodes. Only the
/// difference of the two is of use: errors are not estimated, and both lack the features that the
/// nodes do not resolve. Values are in the order of ReflectionTable::reflection.
LightComparison compare_light(const Stack& stack, const Directions& directions,
                              const SolverOptions& options, SolutionMemory& memory);
/// The same for plane albedos, the spherical albedo and transmittances.
LightComparison compare_albedos(const Stack& stack, const std::vector<double>& mu_in,
                                const SolverOptions& options, SolutionMemory& memory);

}  // namespace miebrdf::rte
