// Optics of an ensemble of spheres: Mie theory averaged over a size distribution.
// Symbols, signs and normalisation: docs/conventions.md.
#pragma once

#include <complex>
#include <memory>
#include <vector>

#include "mie/phase_table.h"
#include "mie/size_distribution.h"

namespace miebrdf::mie {

/// What to compute; what is not asked for is not computed.
struct EnsembleRequest {
    SizeDistribution sizes;
    std::complex<double> refractive_index;  ///< of the particles, n + ik, k >= 0
    double host_index = 1.0;                ///< real index of the medium between them
    double wavelength_nm = 550.0;           ///< in vacuum
    int highest_moment = -1;                ///< chi_0 ... chi_L; -1: no moments
    std::vector<double> angles_deg;         ///< scattering angles for the phase function, 0 to 180
    double tolerance = 1e-4;                ///< relative, of albedo, q_ext and moments
    double phase_tolerance = 1e-2;          ///< relative, of P at each angle; points of P need many
                                            ///< more sizes than moments do
    bool with_phase_table = false;          ///< P at every angle, as a PhaseTable
    double table_tolerance = 1e-3;          ///< of its interpolation, relative within each panel
};

/// Averages by cross-section: albedo = <C_sca>/<C_ext>, chi_l = <C_sca chi_l>/<C_sca>.
struct EnsembleOptics {
    double single_scattering_albedo = 0.0;  ///< in [0, 1]; exactly 1 for k = 0
    double one_minus_albedo = 1.0;          ///< absorption / extinction, summed, never a difference
    double q_ext = 0.0;                     ///< <C_ext> / <pi r^2>
    double q_sca = 0.0;
    double q_abs = 0.0;
    double asymmetry = 0.0;                         ///< g = chi_1
    std::vector<double> chi;                        ///< chi_0 = 1 ... chi_highest_moment
    std::vector<double> phase;                      ///< P at angles_deg; mean over the sphere = 1
    std::shared_ptr<const PhaseTable> phase_table;  ///< null unless asked for
    double error_estimate = 0.0;                    ///< relative, of albedo, q_ext and moments
    double phase_error_estimate = 0.0;              ///< relative, largest over angles_deg
    int size_nodes = 0;
    bool converged = false;  ///< both estimates within their tolerances
};

/// Degree of the last Legendre moment that is not zero within rounding: twice the number of partial
/// waves of the largest sphere.
int highest_moment_of(const EnsembleRequest& request);

/// Averages Mie theory over the sizes.
///
/// @throws std::invalid_argument  for an index, wavelength, angle or distribution out of range,
///         with the value and what is allowed. Not reaching the tolerance is an outcome: read
///         `converged`.
EnsembleOptics average_over_sizes(const EnsembleRequest& request);

}  // namespace miebrdf::mie
