// The keys of a species after its name: sizes, density and amount, as `key=value`.
#pragma once

#include <miebrdf/scene.h>

#include <string>
#include <string_view>

namespace miebrdf {

/// A length in um: `0.1`, `100nm`, `1mm`. @throws UsageError
double parse_length_um(std::string_view text, const std::string& what);
/// The density of a layer in kg/m3: `300`, `300kg/m3`, `0.3g/cm3`. @throws UsageError
double parse_layer_density(std::string_view text, const std::string& what);

/// The sizes of a species: its own over those of the scene.
mie::SizeDistribution sizes_of(const Species& species, const ParticleOptions& of_scene);

/// Whether a species says how large its spheres are, or leaves it to the scene.
bool states_radius(const Species& species);

/// Sizes, density and amount within what they may be.
/// @param text  the species, named in the message
/// @throws UsageError  with the key, its value and the allowed range
void validate_keys(const Species& species, const std::string& text);

/// The keys as they follow a species: `,radius=0.1,distribution=gamma,volume=15%`; empty where
/// nothing is said.
std::string describe_keys(const Species& species);

/// Takes `,radius=UM`, `,variance=V`, `,distribution=KIND`, those of size_words.h,
/// `,coating=NAME@5nm`, `,density=G_CM3`, `,layer-density=KG_M3`, `,volume=SHARE`, `,mass=SHARE`
/// and
/// `,number=PER_CM3` in any order from the end of a text into `species`.
/// @param only_keys  whether any other `,key=value` at the end is a mistake; otherwise it is left
///        to the species (the name of a file may have one)
/// @return the text before the keys
/// @throws UsageError  for unknown keys, with the nearest; for keys given twice; for values that do
///         not read as what they should be
std::string take_keys(const std::string& text, bool only_keys, Species& species);

}  // namespace miebrdf
