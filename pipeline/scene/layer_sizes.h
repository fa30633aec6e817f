// Sizes that the particles of one layer have for themselves, where others have those of the scene.
#pragma once

#include <optional>
#include <string>

#include <miebrdf/sizes.h>

namespace miebrdf {

/// What a layer says about its spheres; what it leaves out is that of its scene.
struct LayerSizes {
    std::optional<double> effective_radius_um;              ///< > 0
    std::optional<double> effective_variance;               ///< > 0, up to 10; ignored for mono
    std::optional<mie::SizeDistributionKind> distribution;  ///< any but tabulated

    bool operator==(const LayerSizes&) const = default;
};

/// The sizes of a layer: its own over those of the scene.
mie::SizeDistribution resolved_sizes(const LayerSizes& own, const mie::SizeDistribution& of_scene);

/// @param layer  named in the message
/// @throws UsageError  with the key, its value and the allowed range
void validate(const LayerSizes& sizes, const std::string& layer);

/// The sizes as they follow a medium: `,radius=0.1,variance=0.3,distribution=gamma`; empty where
/// the layer says nothing.
std::string describe(const LayerSizes& sizes);

/// A medium's text in two: `TiO2,radius=0.1` is `TiO2` and a radius.
struct SizedText {
    std::string medium;
    LayerSizes sizes;
};

/// Takes `,radius=UM`, `,variance=V` and `,distribution=KIND` in any order from the end of a text.
/// @param only_sizes  whether any other `,key=value` at the end is a mistake; otherwise it is left
///        to the medium (the name of a file may have one)
/// @throws UsageError  for unknown keys, with the nearest; for keys given twice; as validate
SizedText split_sizes(const std::string& text, bool only_sizes);

}  // namespace miebrdf
