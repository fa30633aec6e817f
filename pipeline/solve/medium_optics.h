// Single scattering by a medium at one wavelength: the step from refractive index to what
// radiative transfer needs.
#pragma once

#include <complex>
#include <optional>
#include <vector>

#include <miebrdf/ensemble.h>
#include <miebrdf/optics.h>
#include "pipeline/solve/resolved_medium.h"

namespace miebrdf {

/// How much of a medium's optics is wanted; the rest is not computed.
struct OpticsDemand {
    int highest_moment = -1;  ///< chi_0 ... chi_L; -1: none
    /// The phase function at every angle, and all the moments it has (up to kMostMoments).
    bool whole_phase_function = false;
    std::vector<double> angles_deg;  ///< P at these angles, for MediumOptics::phase
    double tolerance = 1e-4;         ///< relative, of the size average
};

/// The cost of moments grows with their square; beyond this many (spheres of about 0.5 mm in
/// visible light) the list is cut short.
constexpr int kMostMoments = 12'000;

struct MediumOptics {
    std::optional<std::complex<double>> refractive_index;  ///< as used; empty if analytic
    rte::Optics optics;
    std::vector<double> phase;    ///< P at the demanded angles_deg, in their order
    double asymmetry = 0.0;       ///< chi_1
    std::optional<double> q_ext;  ///< extinction efficiency; empty if analytic
    double error_estimate = 0.0;  ///< relative, of the size average; 0 if analytic
    bool converged = true;
};

/// @param wavelength_nm  in vacuum
/// @param particles  of the scene; the medium's own sizes come before them
/// @param run  for the pieces of one Mie average (parallel.h)
/// @throws InputError  for a wavelength outside the medium's table
MediumOptics medium_optics(const ResolvedMedium& medium, double wavelength_nm,
                           const ParticleOptions& particles, const OpticsDemand& demand,
                           const mie::Executor& run = mie::run_in_order);

}  // namespace miebrdf
