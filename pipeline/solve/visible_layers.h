// Which layers can be seen from above: what lies below a coat that hides it is not computed.
#pragma once

#include <miebrdf/optics.h>
#include "pipeline/solve/scene_optics.h"

namespace miebrdf {

/// Whether light that went straight through a coat and back is below the tolerance; a coat that
/// lets more through hides nothing, and no optics are needed to know it.
bool may_hide(double optical_depth, const rte::Directions& directions, double tolerance);

/// Whether nothing below a coat shows within a tenth of the tolerance.
///
/// Over a Lambertian ground of albedo 1 and over a black one a coat's plane albedos A differ by
/// V(mu) = T(mu) T / (1 - S), its reflection functions by T(mu) T(mu_0) / (1 - S) =
/// V(mu) V(mu_0) / V with the spherical V = T^2 / (1 - S) (T: transmission, S: reflection from
/// below). Two solutions of order 0 give them. No base returns more light than the white ground;
/// that it may send it elsewhere is what the factor of safety (10) is for.
/// @param directions  without mu_out: only albedos are wanted
bool hides_what_is_below(const rte::Optics& coat, double optical_depth,
                         const rte::Directions& directions, double tolerance);

/// Media of albedo 0 at the bottom of a stack return nothing: a black ground takes their place.
rte::Stack with_black_ground(rte::Stack stack);

/// Optics of the layers that show, at each wavelength: a coat that hides what is below becomes the
/// half-space, and single scattering below it is never computed.
std::vector<SceneOptics> visible_optics(const SceneMedia& media, const Request& request,
                                        const std::vector<double>& wavelength_nm,
                                        const OpticsDemand& demand, const RunControl& control);

}  // namespace miebrdf
