// What physics and statistics say of computed values, and whether a result is converged.
#pragma once

#include <miebrdf/brdf.h>

#include <vector>

#include <miebrdf/optics.h>

namespace miebrdf {

/// Reciprocity and the least value.
/// @param values  BRDF, laid out as BrdfValues::Slice; not empty
PhysicsReport physics_of(const std::vector<double>& values, const Directions& directions);

/// Transparent spheres ripple in size and angle: points of their averaged phase function err by a
/// few parts in a thousand (mie::PhaseTable::noise), independently of each other, and light
/// scattered once brings that into R. Moments, albedos and means over directions average it out, so
/// that it is told beside the error estimate.
///
/// Single scattering as in rte::single_scattering with the noise for P, the layers' contributions
/// added up and nothing weakened by what lies above: an upper estimate of the rms.
///
/// @param reflection  R laid out as BrdfValues::Slice
/// @param moments     kept by delta-M (rte::SolverReport)
PhaseNoise largest_phase_noise(const rte::Stack& stack, const Directions& directions,
                               const std::vector<double>& reflection, int moments);

/// What Mie theory leaves of the tolerance, so that both estimates together stay within it. A
/// tolerance of the size average that leaves nothing was the user's choice: half is for the streams
/// all the same.
double rest_of_tolerance(double tolerance, double mie_error_estimate);

/// The one place that decides whether values are converged: both estimates together are within
/// `tolerance`, and every step says so.
/// @param report  its solver's part is set
void judge(WavelengthReport& report, double mie_error_estimate, bool mie_converged,
           double tolerance);

}  // namespace miebrdf
