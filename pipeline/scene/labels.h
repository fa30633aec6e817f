// Scenes in words for people: what stands on charts and pages, without the notation of options.
#pragma once

#include <miebrdf/scene.h>

#include <string>
#include <vector>

namespace miebrdf {

/// "TiO2, radius 0.1 µm, 15 % of the volume in PMMA"; "Henyey-Greenstein, albedo 0.9, g 0.75".
std::string label_of(const Medium& medium);
/// "τ = 0.1", "τ = 0.1 at 450 nm", "40 µm", "2 kg/m²", "opaque".
std::string label_of(const Depth& depth);
/// "ground of albedo 0.8", "black ground", "mirror of Au".
std::string label_of(const Substrate& substrate);
/// From the top down: "AlGaAs7 (τ = 0.1) on TiO2, roughness 0.3".
std::string label_of(const Scene& scene);

/// The label without depths: "AlGaAs7 on TiO2, roughness 0.3".
std::string media_of(const Scene& scene);

/// One label for each scene, which says no more than what tells them apart: "τ = 0.1" and "τ = 1"
/// where a depth alone differs, else the scene without the phrases at its ends that all scenes
/// share. Empty for a single scene.
std::vector<std::string> labels_of(const std::vector<Scene>& scenes);

}  // namespace miebrdf
