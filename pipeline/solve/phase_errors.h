// Errors of the phase function change R at single directions; a few of them are cured here.
#pragma once

#include <miebrdf/brdf.h>

#include <vector>

#include <miebrdf/ensemble.h>
#include <miebrdf/optics.h>
#include "pipeline/solve/single_scattering.h"

namespace miebrdf {

/// A scene's layers at one wavelength, solved.
struct SolvedLayers {
    const rte::Stack& stack;
    const Directions& directions;
    int moments = 0;  ///< kept by delta-M (rte::SolverReport)
    bool delta_m = true;
    const std::vector<double>& transfer_errors;  ///< of rte::ReflectionTable
};

struct PhaseErrors {
    PhaseNoise noise = {};
    /// Largest over the values: what transfer errs by and twice the noise.
    double with_transfer = 0.0;
};

/// Transparent spheres ripple in size and angle: points of their averaged phase function err by a
/// few parts in a thousand (mie::PhaseTable::noise), independently of each other, and light
/// scattered once brings that into R. Moments, albedos and means over directions average it out.
///
/// Single scattering with the noise for P, weakened by what lies above; layers err independently.
/// Where the moments come from the same table, its errors are in both, and light that is diffracted
/// before or after counts by what degree they belong to (rte/first_order/glory_correction.h).
///
/// @param reflection  R laid out as BrdfValues::Slice
PhaseErrors phase_errors(const SolvedLayers& layers, const std::vector<double>& reflection);

/// True if a layer has a phase function that errs at single angles.
bool has_noisy_phase(const rte::Stack& stack);

/// P anew, at the angles of directions where twice the noise is above `allowed`, from as many sizes
/// as that takes; R is linear in P there.
/// @param w           the wavelength
/// @param allowed     of each value, relative to the largest value at its incidence
/// @param reflection  corrected
/// @return what is left
PhaseErrors refine_phase(const ResolvedScene& scene, std::size_t w, const OpticsDemand& demand,
                         const SolvedLayers& layers, const std::vector<double>& allowed,
                         std::vector<double>& reflection, const mie::Executor& run);

}  // namespace miebrdf
