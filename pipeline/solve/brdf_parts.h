// A Brdf puts its layers and its surface together here.
#pragma once

#include <miebrdf/brdf.h>

#include <optional>
#include <vector>

#include "pipeline/solve/layers.h"
#include "pipeline/solve/surface_part.h"

namespace miebrdf {

/// The surface's part that slice_of needs; nothing of scenes and parts without one.
std::optional<SurfacePart> surface_of(const ResolvedScene& scene, std::size_t w,
                                      const Directions& directions, const BrdfParts& parts,
                                      const Control& control);

/// The parts of a BRDF at one wavelength from its layers.
/// @param surface  of surface_of
BrdfValues::Slice slice_of(LayerSlice layer, const ResolvedScene& scene,
                           const std::optional<SurfacePart>& surface, const Directions& directions,
                           const BrdfParts& parts);

/// The layers as far as these parts need them.
std::vector<LayerSlice> layers_of(const BrdfState& state, const Directions& directions,
                                  const BrdfParts& parts);

BrdfValues brdf_values(std::vector<LayerSlice> layers, const BrdfState& state,
                       const Directions& directions, const BrdfParts& parts);

/// @param layers  of albedo_quantity, without the surface
AlbedoValues albedo_of(const BrdfState& state, std::vector<LayerSlice> layers,
                       const std::vector<double>& mu_in);

/// @param layers  the same with the surface (SurfaceOverAlbedos)
AlbedoValues albedo_values(std::vector<LayerSlice> layers, const ResolvedScene& scene,
                           const std::vector<double>& mu_in, const SolverOptions& solver);

}  // namespace miebrdf
