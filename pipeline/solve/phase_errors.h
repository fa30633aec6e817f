// Errors of phase functions at single angles: their effect on R, and new values of P where it is
// too large.
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
    /// (Error of transfer) + 2 noise of each value, relative to the largest at its incidence.
    std::vector<double> of_values = {};
    double with_transfer = 0.0;  ///< the largest of them
};

/// The error of R by the noise of P. P of transparent spheres ripples in size and angle: points of
/// the average err by a few 1e-3 (mie::PhaseTable::noise), independently of each other, and light
/// scattered once carries these errors into R. In moments, albedos and means over directions they
/// cancel.
///
/// Each layer adds (dR/dP of light scattered once) x noise, independently of other layers. Where
/// the moments come from the same table, they have the errors, too; their effect through the
/// forward peak depends on the degree (rte/first_order/glory_correction.h).
///
/// @param reflection  R laid out as BrdfValues::Slice
PhaseErrors phase_errors(const SolvedLayers& layers, const std::vector<double>& reflection);

/// Whether a layer has a phase function with errors at single angles.
bool has_noisy_phase(const rte::Stack& stack);

/// Recomputes P, with more sizes, at the angles of directions where twice the noise exceeds
/// `allowed`, and corrects R, which is linear in P there.
/// @param w           the wavelength
/// @param allowed     of each value, relative to the largest value at its incidence
/// @param reflection  corrected
/// @return the errors left
PhaseErrors refine_phase(const ResolvedScene& scene, std::size_t w, const OpticsDemand& demand,
                         const SolvedLayers& layers, const std::vector<double>& allowed,
                         std::vector<double>& reflection, const mie::Executor& run);

}  // namespace miebrdf
