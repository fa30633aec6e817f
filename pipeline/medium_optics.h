// Single scattering by a medium at one wavelength: the step from refractive index to what
// radiative transfer needs.
#pragma once

#include <complex>
#include <optional>
#include <vector>

#include "pipeline/resolved_medium.h"
#include "rte/optics.h"

namespace miebrdf {

/// How much of a medium's optics is wanted; the rest is not computed.
struct OpticsDemand {
    int highest_moment = -1;         ///< chi_0 ... chi_L; -1: none
    std::vector<double> angles_deg;  ///< where the exact phase function will be asked for
    double tolerance = 1e-4;         ///< relative, of the size average
};

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
/// @throws InputError  for a wavelength outside the medium's table
MediumOptics medium_optics(const ResolvedMedium& medium, double wavelength_nm,
                           const ParticleOptions& particles, const OpticsDemand& demand);

}  // namespace miebrdf
