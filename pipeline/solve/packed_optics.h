// Single scattering by a medium as a row of numbers and back, for the cache.
#pragma once

#include <vector>

#include "pipeline/solve/medium_optics.h"

namespace miebrdf {

/// @param optics  from Mie theory: its phase function is a mie::PhaseTable or empty
std::vector<double> packed(const MediumOptics& optics);

/// @throws std::runtime_error, std::invalid_argument  for numbers that are no packed optics
MediumOptics unpacked_optics(const std::vector<double>& numbers);

}  // namespace miebrdf
