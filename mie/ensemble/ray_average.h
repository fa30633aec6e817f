// Averages over broad distributions of large spheres by rays, where their error is known to be
// small.
#pragma once

#include <optional>

#include <miebrdf/ensemble.h>
#include "mie/ensemble/adaptive_phase.h"
#include "mie/ensemble/particle_ensemble.h"

namespace miebrdf::mie {

/// Rays take products in single precision: for no finer tolerance.
constexpr double kLeastToleranceOfRays = 1e-6;

/// The cost of leaving out the phases between rays, before anything is computed: a bound of the
/// relative error of extinction and of the absolute ones of moments, found over random ensembles
/// (docs/maths-mie.md#rays). Infinite where rays are no description: sizes without a density or
/// with bends, |m| near or below 1, or damped ripple.
struct RayBound {
    double ends = 0;    ///< of distributions that end sharply
    double spread = 0;  ///< sizes too alike or too small for phases to average out
    double total() const { return ends + spread; }
};
RayBound ray_bound(const Ensemble& ensemble);

/// The error of P by rays, rms over the angles, found in the same way.
/// @param exact  of PairedSizeSamples::Method::exact_rays
PhaseRayBias phase_ray_bias(const Ensemble& ensemble, bool exact = false);

/// Efficiencies, albedo, g and chi_0 ... chi_highest by sum_over_rays, when the error estimate is
/// within the tolerance; nothing otherwise. The estimate is ray_bound and what the rule
/// over sizes leaves in moments, measured over random ensembles.
/// @param highest_moment  -1: none
std::optional<EnsembleOptics> average_over_rays(const Ensemble& ensemble, int highest_moment,
                                                double tolerance, const Executor& run);

}  // namespace miebrdf::mie
