// A request as the methods that average over sizes see it.
#pragma once

#include <vector>

#include <miebrdf/ensemble.h>
#include "mie/sizes/size_law.h"
#include "mie/sphere/flush_to_zero.h"
#include "mie/sphere/scatterer.h"

namespace miebrdf::mie {

/// Particles and their sizes: handed whole from one method to the next.
struct Ensemble {
    Scatterer scatterer;
    SizeDistribution sizes;
    RadiusRange range;              ///< of the sizes that are summed
    double share = 1;               ///< of the geometric cross-section, inside the range
    double wave_number_per_um = 0;  ///< 2 pi n_host / lambda

    const SizeLaw& law() const { return SizeLaw::of(sizes.kind); }
    double smallest_x() const { return wave_number_per_um * range.smallest_um; }
    double largest_x() const { return wave_number_per_um * range.largest_um; }
    double effective_x() const { return wave_number_per_um * effective_radius_of(sizes); }
    double width_in_x() const { return largest_x() - smallest_x(); }
    /// Whether resonances are narrow: beyond k x = 1 absorption has widened all of them.
    bool ripples() const { return !(scatterer.damping(effective_x()) > 1); }
    int terms() const { return scatterer.terms(largest_x()); }  ///< of the largest particle
    /// P is a trigonometric polynomial of degree 2 x: nothing in it is finer than this, in radians.
    double finest_angle() const;
};

/// @throws UsageError  with the value and what is allowed; angles are checked by require_angles
void validate(const EnsembleRequest& request);
void require_angles(const std::vector<double>& angles_deg);

/// @param request  valid
Ensemble ensemble_of(const EnsembleRequest& request);

double wave_number_per_um(const EnsembleRequest& request);

/// The share of the scattering that a size distribution without ends leaves out: well below the
/// error that is asked of the result.
double tail_for(const EnsembleRequest& request);

/// Every thread that takes a piece of the work flushes denormal numbers meanwhile. The caller
/// around it does not: threads that `run` starts would inherit that for good.
/// @param run  must outlive the result
inline Executor flushing(const Executor& run) {
    return [&run](int count, const std::function<void(int)>& job) {
        run(count, [&job](int i) {
            const FlushToZero flush;
            job(i);
        });
    };
}

/// Absorption over extinction, reduced by similarity (van de Hulst 1980).
double similar_absorption(const EnsembleOptics& optics);
/// Spherical albedo of a half-space, by similarity (van de Hulst 1980, table 25).
double half_space_albedo(const EnsembleOptics& optics);

}  // namespace miebrdf::mie
