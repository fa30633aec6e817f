// Derivatives of the layers of a scene by the numbers in its words.
#pragma once

#include <string>
#include <vector>

#include "pipeline/solve/brdf_state.h"
#include "pipeline/solve/layers.h"

namespace miebrdf {

/// A scene with one number a little larger and a little smaller.
struct SceneChange {
    std::string parameter;
    ResolvedScene plus, minus;
    /// (Number of `plus`) - (number of `minus`) at every wavelength; 0 where it has no meaning.
    std::vector<double> apart;
};

/// @param parameter  a name of named_numbers, `n(NAME)` or `k(NAME)`
/// @throws UsageError  for a parameter that the scene does not have
SceneChange change_of(const BrdfState& state, const std::string& parameter);

/// For each change and wavelength a slice that holds derivatives in place of values; empty where
/// the layers do not change.
/// @param values  compute_layers() of the same request
/// @throws UsageError  where a derivative has no bound
std::vector<std::vector<LayerSlice>> layer_derivatives(const LayerRequest& request,
                                                       const std::vector<LayerSlice>& values,
                                                       const std::vector<SceneChange>& changes,
                                                       const Control& control);

}  // namespace miebrdf
