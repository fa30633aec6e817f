// Layers at one wavelength as the cache keeps them: their name and their numbers.
#pragma once

#include <string>
#include <vector>

#include "pipeline/solve/layers.h"

namespace miebrdf {

/// Names the job of one wavelength: everything its slice depends on.
/// @param request  its directions as the solver gets them (distinct_directions.h)
std::string layer_hash(const Request& request, const SceneMedia& media, LayerQuantity quantity,
                       double wavelength_nm);

std::vector<double> packed(const LayerSlice& slice);
/// @throws std::runtime_error  when the numbers are not those of a slice
LayerSlice unpacked_layers(const std::vector<double>& numbers);

}  // namespace miebrdf
