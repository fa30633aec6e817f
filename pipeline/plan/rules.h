// What a request does not need: the rules by which work is left out, each a question that both the
// computation and `plan` ask. Rules that look at directions, media and parts are here; those that
// need the optics of a coat are in visible_layers.h, those of the solver itself in rte/.
#pragma once

#include "pipeline/scene/request.h"
#include "pipeline/solve/resolved_medium.h"

namespace miebrdf {

/// A coat without optical depth: neither its optics nor its modes are computed. It may still give
/// the surface its refractive index.
bool has_no_depth(const CoatMedium& coat);
Scene without_empty_coats(Scene scene);

/// Whether radiative transfer is needed at all: not for the surface lobe alone.
bool wants_layers(const BrdfParts& parts);
/// Whether the lobe and its rho are needed: only with a surface, and not for the layers alone.
bool wants_lobe(const Scene& scene, const BrdfParts& parts);

/// Light from or to the zenith has no azimuth: order 0 alone.
bool only_zenith(const rte::Directions& directions);

/// Directions across the plane of incidence (azimuth 90 or 270 degrees) alone: odd orders vanish.
bool only_across(const rte::Directions& directions);

/// A list of incident cosines that is also that of the outgoing ones: half of the pairs follow from
/// reciprocity where the quantity is symmetric.
bool is_symmetric(const rte::Directions& directions);

/// Absorbs nothing at a wavelength (albedo 1, or k = 0): where this holds for every layer, what
/// enters a half-space leaves it, and its plane albedo is 1.
bool absorbs_nothing(const ResolvedMedium& medium, double wavelength_nm, double k_floor);

/// Scatters nothing (albedo 0): black as a base.
bool scatters_nothing(const Medium& medium);

/// Most Fourier orders of radiative transfer by a medium whose moments are known without computing
/// (isotropic 1, Rayleigh 3, moments:FILE their number); 0: not known beforehand.
int most_orders(const Medium& medium);
/// The same for a whole scene: the largest, or 0 where any layer is unknown.
int most_orders(const Scene& scene);

}  // namespace miebrdf
