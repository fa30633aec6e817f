// The stack of layers that radiative transfer gets at each wavelength: what shows, and its optics.
#pragma once

#include <miebrdf/brdf.h>

#include <miebrdf/optics.h>
#include "pipeline/solve/single_scattering.h"

namespace miebrdf {

/// A scene at one wavelength, ready for radiative transfer.
struct SceneOptics {
    rte::Stack stack;
    std::vector<double> optical_depths = {};  ///< of all layers, also of those that do not show
    double mie_error_estimate = 0.0;          ///< largest of the media
    bool converged = true;
    std::size_t lowest_medium = 0;  ///< of the scene, that shows
};

/// Optics of the layers that show from above, at some of the scene's wavelengths: a layer that
/// hides what is below becomes the half-space, and single scattering below it is never computed.
/// @param directions  where the scene is looked at; without mu_out: only albedos are wanted
std::vector<SceneOptics> visible_optics(const ResolvedScene& scene, const Directions& directions,
                                        double tolerance,
                                        const std::vector<std::size_t>& wavelengths,
                                        const OpticsDemand& demand, const Control& control);

/// As above, with scattering matrices at the wavelengths where these are wanted.
/// @param polarised  [place in `wavelengths`]
std::vector<SceneOptics> visible_optics(const ResolvedScene& scene, const Directions& directions,
                                        double tolerance,
                                        const std::vector<std::size_t>& wavelengths,
                                        const std::vector<char>& polarised, OpticsDemand demand,
                                        const Control& control);

/// As above, with the layers from a given medium up, whatever they hide: a scene a little different
/// from one of which that is known.
/// @param lowest_medium  as of SceneOptics
std::vector<SceneOptics> optics_from(const ResolvedScene& scene, std::size_t lowest_medium,
                                     const std::vector<std::size_t>& wavelengths,
                                     const OpticsDemand& demand, const Control& control);

/// Refuses, without computing anything, a scene that cannot be solved at this wavelength: its
/// species (require_computable of single_scattering.h), light of several components that it cannot
/// have, indices that its boundary does not take. Layers that others hide count, too.
/// @throws UsageError, InputError
void require_computable(const ResolvedScene& scene, const SolverOptions& solver, std::size_t w);

/// Directions as the layers under a scene's boundary see them.
Directions below_boundary(const ResolvedScene& scene, std::size_t wavelength,
                          const Directions& directions);

/// The tolerance of what a layer may hide. Boundaries send light back to where it may be hidden
/// again: less by what is left of the light outside, and by how often it returns (index 3).
double hiding_tolerance(const ResolvedScene& scene, double tolerance);

}  // namespace miebrdf
