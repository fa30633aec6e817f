// Building a PhaseTable: which angles, how many sizes for each, and P there.
#pragma once

#include <complex>
#include <limits>
#include <vector>

#include <miebrdf/ensemble.h>

namespace miebrdf::mie {

/// What P by rays errs by, rms over the angles.
struct PhaseRayBias {
    /// Relative to max(P, 1/2). 0: P is not to be computed by rays (no RayBound, or too few ripples
    /// for rays to be cheaper).
    double everywhere = 0;
    /// What rays of different ways p and q leave at sharp ends of the sizes, relative to the root
    /// of the sum of P_p P_q over p != q.
    double ends = 0;

    double typical() const { return everywhere + 0.3 * ends; }
};

struct PhaseTabulationOptions {
    double interpolation_tolerance = 1e-3;  ///< relative to the largest P of each panel
    double size_tolerance = 1e-2;  ///< relative to max(P, floor), rms over the nodes of each panel
    double floor = 0;
    int first_moment = 0;  ///< lowest one that will be asked of the table
    int last_moment = -1;  ///< highest one; -1: none
    /// Scattering efficiency of the average times the area share of the range, when known. 0: not.
    double scattering_efficiency = 0;
    bool by_rays = false;        ///< see RayFamilies
    PhaseRayBias ray_bias = {};  ///< part of the noise by rays, relative to max(P, floor)
    double most_work = std::numeric_limits<double>::infinity();  ///< EnsembleRequest::phase_work
    double moment_tolerance = 1.0;  ///< absolute, of what each panel gives to a moment
};

struct TabulatedPhase {
    PhaseTable table;
    double moment_error = 0;  ///< absolute, of the table's moments from first_moment to last_moment
};

/// Each panel of scattering angles takes levels of sizes (SizeFamilies) until the two families
/// agree within the tolerance: most panels need the first one only, interferences in step with a
/// family's spacing and some glories two or three. Panels whose polynomial has not converged (its
/// last two Chebyshev coefficients are above the tolerance and above the noise of the sizes) are
/// halved, and the halves start anew, but for parts of P that the polynomial has, together with all
/// others of their generation. Neighbours share the value at their common edge: that of the panel
/// with more sizes.
///
/// Amplitudes are summed in single precision: 1e-5 of P at worst, half the time.
TabulatedPhase tabulate_phase(std::complex<double> relative_index,
                              const SizeDistribution& distribution, const RadiusRange& range,
                              double wave_number_per_um, const PhaseTabulationOptions& options,
                              const Executor& run);

/// P at single angles, each with levels of sizes until its two families agree there and about a
/// period of the fastest wave to both sides, and the last level has changed little: neither its
/// value nor its error depends on the other angles.
/// @param options  size_tolerance (which also bounds the finest level), floor and
///                 scattering_efficiency count
/// @param allowed  absolute error of P at each angle; empty: size_tolerance, relative to
///                 max(P, floor)
PhaseValues phase_at_angles(std::complex<double> relative_index,
                            const SizeDistribution& distribution, const RadiusRange& range,
                            double wave_number_per_um, const PhaseTabulationOptions& options,
                            const std::vector<double>& angles_deg,
                            const std::vector<double>& allowed, const Executor& run);

/// P at those of many angles that lie close together, from polynomials on panels that take levels
/// of sizes until noise and interpolation are within what is allowed.
/// @param allowed  absolute error of P at each angle
/// @param result   of these angles alone
/// @return the other angles, few on any panel
std::vector<std::size_t> phase_on_panels(std::complex<double> relative_index,
                                         const SizeDistribution& distribution,
                                         const RadiusRange& range, double wave_number_per_um,
                                         const PhaseTabulationOptions& options,
                                         const std::vector<double>& angles_deg,
                                         const std::vector<double>& allowed, const Executor& run,
                                         PhaseValues& result);

}  // namespace miebrdf::mie
