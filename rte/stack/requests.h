// Steps that requests for reflections and for albedos have in common.
#pragma once

#include <cstddef>
#include <vector>

#include <miebrdf/transfer.h>
#include "rte/phase/stack_of_media.h"

namespace miebrdf::rte {

/// @throws UsageError  for cosines outside (0, 1]
void require_cosines(const std::vector<double>& cosines, const char* field);
/// @throws UsageError  for methods and boundaries that numbers alone can have
void require_polarisable(const Stack& stack, const SolverOptions& options);

/// The stack with as many moments as the longest list of its media's coefficients, so that whatever
/// chooses by the number of moments sees them all.
Stack with_all_moments(Stack stack);

/// [pair][element][azimuth], as FirstOrderSum has them, to [pair][azimuth][element].
std::vector<double> elements_last(std::vector<double> values, std::size_t elements,
                                  std::size_t azimuths);

/// ReflectionTable::mirror_reflectance. Nothing scattered is taken for a beam here: with the
/// optical depths as they are.
/// @param exact         memory that is used again
/// @param reflectances  overwritten
void find_mirror_reflectances(const Stack& stack, const std::vector<double>& mu_in,
                              const SolvedLight& light, ScaledStack& exact,
                              std::vector<double>& reflectances);

/// AlbedoTable::unscattered_transmittance, likewise.
/// @param shares  overwritten
void find_unscattered(const Stack& stack, const std::vector<double>& mu_in, int components,
                      ScaledStack& exact, std::vector<double>& shares);

}  // namespace miebrdf::rte
