// The stack of layers that radiative transfer gets at each wavelength: what shows, and its optics.
#pragma once

#include <miebrdf/brdf.h>

#include <miebrdf/optics.h>
#include "pipeline/solve/single_scattering.h"

namespace miebrdf {

/// A scene at one wavelength, ready for radiative transfer.
struct SceneOptics {
    rte::Stack stack;
    double mie_error_estimate = 0.0;  ///< largest of the media
    bool converged = true;
};

/// Whether light that went straight through a coat and back is below the tolerance; a coat that
/// lets more through hides nothing, and no optics are needed to know it.
bool may_hide(double optical_depth, const Directions& directions, double tolerance);

/// Whether nothing below a coat shows within a tenth of the tolerance.
///
/// Over a Lambertian ground of albedo 1 and over a black one a coat's plane albedos A differ by
/// V(mu) = T(mu) T / (1 - S), its reflection functions by T(mu) T(mu_0) / (1 - S) =
/// V(mu) V(mu_0) / V with the spherical V = T^2 / (1 - S) (T: transmission, S: reflection from
/// below). Two solutions of order 0 give them. No base returns more light than the white ground;
/// that it may send it elsewhere is what the factor of safety (10) is for.
/// @param directions  without mu_out: only albedos are wanted
bool hides_what_is_below(const rte::Optics& coat, double optical_depth,
                         const Directions& directions, double tolerance);

/// Optics of the layers that show from above, at some of the scene's wavelengths: a layer that
/// hides what is below becomes the half-space, and single scattering below it is never computed.
/// @param directions  where the scene is looked at; without mu_out: only albedos are wanted
std::vector<SceneOptics> visible_optics(const ResolvedScene& scene, const Directions& directions,
                                        double tolerance,
                                        const std::vector<std::size_t>& wavelengths,
                                        const OpticsDemand& demand, const Control& control);

}  // namespace miebrdf
