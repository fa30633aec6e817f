// A Brdf puts its layers and its surface together here.
#pragma once

#include <miebrdf/brdf.h>

#include <vector>

#include "pipeline/solve/layers.h"

namespace miebrdf {

/// The parts of a BRDF at one wavelength from its layers.
BrdfValues::Slice slice_of(LayerSlice layer, const ResolvedScene& scene, std::size_t w,
                           const Directions& directions, const BrdfParts& parts,
                           const Control& control);

/// The layers as far as these parts need them.
std::vector<LayerSlice> layers_of(const BrdfState& state, const Directions& directions,
                                  const BrdfParts& parts);

BrdfValues brdf_values(std::vector<LayerSlice> layers, const BrdfState& state,
                       const Directions& directions, const BrdfParts& parts);

/// @param layers  of albedo_quantity, without the surface
AlbedoValues albedo_of(const BrdfState& state, std::vector<LayerSlice> layers,
                       const std::vector<double>& mu_in);

/// @param layers  the same with the surface (add_surface_to_albedos)
AlbedoValues albedo_values(std::vector<LayerSlice> layers, const ResolvedScene& scene,
                           const std::vector<double>& mu_in, const SolverOptions& solver);

}  // namespace miebrdf
