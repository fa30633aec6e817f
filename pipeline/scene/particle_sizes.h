// Sizes of particles: a layer's own over those of its scene, and as words.
#pragma once

#include <miebrdf/scene.h>

#include <string>

namespace miebrdf {

/// The sizes of a medium: its own over those of the scene.
mie::SizeDistribution sizes_of(const Medium& medium, const ParticleOptions& of_scene);

/// @param layer  named in the message
/// @throws UsageError  with the key, its value and the allowed range
void validate(const ParticleSizes& sizes, const std::string& layer);

/// The sizes as they follow a medium: `,radius=0.1,variance=0.3,distribution=gamma`; empty where
/// nothing is said.
std::string describe(const ParticleSizes& sizes);

/// A medium's text in two: `TiO2,radius=0.1` is `TiO2` and a radius.
struct SizedText {
    std::string medium;
    ParticleSizes sizes;
};

/// Takes `,radius=UM`, `,variance=V` and `,distribution=KIND` in any order from the end of a text.
/// @param only_sizes  whether any other `,key=value` at the end is a mistake; otherwise it is left
///        to the medium (the name of a file may have one)
/// @throws UsageError  for unknown keys, with the nearest; for keys given twice; as validate
SizedText split_sizes(const std::string& text, bool only_sizes);

}  // namespace miebrdf
