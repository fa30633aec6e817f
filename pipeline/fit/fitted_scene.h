// The fitted scene as a scene file.
#pragma once

#include <miebrdf/fit.h>

#include <string>

namespace miebrdf::fitting {

/// One [[result]] for each data set, at its wavelengths and directions; where
/// unknowns differ between wavelengths, one for each.
std::string fitted_scene(const FitProblem& problem, const FitResult& result);

}  // namespace miebrdf::fitting
