// From a scene to the stack of layers that radiative transfer solves at a wavelength: the layers
// that can be seen, with their optics.
#pragma once

#include <miebrdf/brdf.h>

#include <miebrdf/optics.h>
#include "pipeline/solve/single_scattering.h"

namespace miebrdf {

/// A scene at one wavelength, ready for radiative transfer.
struct SceneOptics {
    rte::Stack stack;
    std::vector<double> optical_depths = {};  ///< of all layers of the scene, hidden ones too
    double mie_error_estimate = 0.0;          ///< largest of the media
    bool converged = true;
    std::size_t lowest_medium = 0;  ///< index in the scene of the lowest medium that is not hidden
};

/// Optics of the layers that can be seen from above, at some of the scene's wavelengths. A layer
/// that hides those below becomes the half-space, and single scattering below it is never computed.
/// @param directions  of the request; without mu_out: only albedos are wanted
std::vector<SceneOptics> visible_optics(const ResolvedScene& scene, const Directions& directions,
                                        double tolerance,
                                        const std::vector<std::size_t>& wavelengths,
                                        const OpticsDemand& demand, const Control& control);

/// The same, with scattering matrices at some of the wavelengths.
/// @param polarised  [place in `wavelengths`]: matrices are wanted
std::vector<SceneOptics> visible_optics(const ResolvedScene& scene, const Directions& directions,
                                        double tolerance,
                                        const std::vector<std::size_t>& wavelengths,
                                        const std::vector<char>& polarised, OpticsDemand demand,
                                        const Control& control);

/// Optics of the layers from a given medium up, whether hidden or not: for a scene a little
/// different from one whose lowest visible medium is known.
/// @param lowest_medium  SceneOptics::lowest_medium of that scene
std::vector<SceneOptics> optics_from(const ResolvedScene& scene, std::size_t lowest_medium,
                                     const std::vector<std::size_t>& wavelengths,
                                     const OpticsDemand& demand, const Control& control);

/// Refuses, without computing anything, a scene that cannot be solved at this wavelength, because
/// of a species (require_computable of single_scattering.h), of polarisation, or of a refractive
/// index below the boundary. Hidden layers are checked, too.
/// @throws UsageError, InputError
void require_computable(const ResolvedScene& scene, const SolverOptions& solver, std::size_t w);

/// Directions below the boundary of a scene, refracted by it.
Directions below_boundary(const ResolvedScene& scene, std::size_t wavelength,
                          const Directions& directions);

/// The tolerance for layers that are taken as hidden: 0.01 of the tolerance below a boundary, which
/// lets out a part of the light alone and sends the rest back repeatedly (0.01 is for index 3).
double hiding_tolerance(const ResolvedScene& scene, double tolerance);

}  // namespace miebrdf
