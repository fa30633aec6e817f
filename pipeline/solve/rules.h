// Rules leave out what a request does not need: each is a question that both the solver and `plan`
// ask. Rules that look at directions, media and parts are here; those that need the optics of a
// layer are in scene_optics.h, those of the equations themselves in rte/.
#pragma once

#include <miebrdf/brdf.h>

#include "pipeline/solve/resolved_scene.h"

namespace miebrdf {

/// Whether nothing of a layer is needed: it has no depth, and its host no surface that refracts.
bool is_left_out(const Scene& scene, const Layer& layer);

/// Whether radiative transfer is needed at all: not for the surface lobe alone.
bool wants_layers(const BrdfParts& parts);
/// Whether the lobe and its rho are needed: only with a surface, and not for the layers alone.
bool wants_lobe(const ResolvedScene& scene, const BrdfParts& parts);

/// Light from or to the zenith has no azimuth: Fourier order 0 alone.
bool only_zenith(const Directions& directions);

/// Directions across the plane of incidence (azimuth 90 or 270 degrees) alone: odd Fourier orders
/// vanish.
bool only_across(const Directions& directions);

/// A list is empty: there is no combination of directions, and no value.
bool has_no_pairs(const Directions& directions);

/// A list of incident cosines that is also that of the outgoing ones: half of the pairs follow from
/// reciprocity where the quantity is symmetric.
bool is_symmetric(const Directions& directions);

/// Absorbs nothing at a wavelength (albedo 1, or k = 0): where this holds for every layer, what
/// enters a half-space leaves it, and its plane albedo is 1.
bool absorbs_nothing(const ResolvedMedium& medium, std::size_t w);
bool absorbs_nothing(const ResolvedScene& scene, std::size_t w);

/// Scatters nothing (albedo 0): black as a base.
bool scatters_nothing(const ResolvedMedium& medium);

/// Most Fourier orders of radiative transfer by media whose moments are known without computing;
/// 0 where any is unknown.
int most_fourier_orders(const ResolvedScene& scene);

}  // namespace miebrdf
