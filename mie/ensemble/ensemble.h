// Optics of an ensemble of spheres: Mie theory averaged over a size distribution.
// Symbols, signs and normalisation: docs/conventions.md.
#pragma once

#include <memory>
#include <vector>

#include "mie/ensemble/ensemble_request.h"
#include "mie/ensemble/executor.h"
#include "mie/ensemble/phase_table.h"

namespace miebrdf::mie {

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
    /// Both estimates within their tolerances, that of the moments for those of the band: moments
    /// from the phase table (hundreds asked) are as good as its sizes allow, and are in
    /// error_estimate only.
    bool converged = false;
};

/// Averages Mie theory over the sizes.
///
/// @throws std::invalid_argument  for an index, wavelength, angle or distribution out of range,
///         with the value and what is allowed. Not reaching the tolerance is an outcome: read
///         `converged`.
/// @param run  runs pieces of the work; the result does not depend on it, bit for bit
EnsembleOptics average_over_sizes(const EnsembleRequest& request,
                                  const Executor& run = run_in_order);

}  // namespace miebrdf::mie
