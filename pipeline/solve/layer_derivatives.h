// Derivatives of the layers of a scene, beside their values.
#pragma once

#include <vector>

#include "pipeline/solve/layers.h"
#include "pipeline/solve/scene_changes.h"

namespace miebrdf {

/// For each change one slice for each wavelength with derivatives in the place of values; empty
/// ones where the layers do not change.
/// @param values  of the same request (compute_layers)
/// @throws UsageError  where a derivative has no bound
std::vector<std::vector<LayerSlice>> layer_derivatives(const LayerRequest& request,
                                                       const std::vector<LayerSlice>& values,
                                                       const std::vector<SceneChange>& changes,
                                                       const Control& control);

}  // namespace miebrdf
