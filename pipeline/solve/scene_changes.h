// A scene with one number a little larger and a little smaller: what derivatives are made of.
#pragma once

#include <string>
#include <vector>

#include "pipeline/solve/brdf_state.h"

namespace miebrdf {

struct SceneChange {
    std::string parameter;
    ResolvedScene plus, minus;
    /// The difference of the number, at every wavelength; 0 where it has no meaning.
    std::vector<double> apart;
};

/// @param parameter  a name of named_numbers, `n(NAME)` or `k(NAME)`
/// @throws UsageError  for a parameter that the scene does not have
SceneChange change_of(const BrdfState& state, const std::string& parameter);

}  // namespace miebrdf
