// A request as the methods that average over sizes see it.
#pragma once

#include <algorithm>
#include <numbers>
#include <vector>

#include <miebrdf/ensemble.h>
#include "mie/sizes/size_law.h"
#include "mie/sphere/flush_to_zero.h"
#include "mie/sphere/scatterer.h"

namespace miebrdf::mie {

/// Limits that all averages share.
struct AverageLimits {
    /// No estimate is below what rounding leaves.
    static constexpr double kRounding = 1e-13;
    /// No error of an average below this share of its tolerance is stated: no estimate sees the
    /// sizes that laws without ends leave out (tail_for), nor products in single precision.
    static constexpr double kLeastStated = 0.1;
    /// One part of several may have this share of the tolerance.
    static constexpr double kPartShare = 0.25;
    /// Random errors exceed this many times their rms in 0.3 % of all cases.
    static constexpr double kDeviations = 3;
    /// Where nothing else is asked for, P below this errs relative to this.
    static constexpr double kDim = 0.5;
    /// Products in single precision change moments by 5e-9 (docs/maths-mie.md#average-over-sizes).
    static constexpr double kLeastSingleTolerance = 1e-7;
    /// P in single precision errs by this share of it at most: averages of 120 random ensembles, up
    /// to 3,300 partial waves, by 1.1e-6.
    static constexpr double kSingleError = 1e-5;
    /// Products of sizes, partial waves and angles: so many a second were measured on a Zen
    /// 4 core, right to a factor of three elsewhere; no further pass of sizes begins beyond the
    /// most, some 25 s.
    static constexpr double kProductsPerSecond = 4e9, kMostProducts = 25 * kProductsPerSecond;
    /// Beyond so many moments a table of P costs less than a band of products as wide; of those
    /// that a table gives, the first come from a band as wide as this: they are more exact.
    static constexpr int kMostBandWidth = 200, kSafeBandWidth = 64;
    /// Glories and the second rainbow begin here: few rays, many of which interfere.
    static constexpr double kBackward = 165 * std::numbers::pi / 180;
};

/// Size parameters of averages: waves and rays of larger spheres are untested.
constexpr double kLargestInEnsemble = 1e6;
/// Coated ones take .8 GB here, and go without rays.
constexpr double kLargestCoated = 1e5;

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

inline double stated_error(double estimate, double tolerance) {
    return std::max(estimate, AverageLimits::kLeastStated * tolerance);
}
/// Whether P, and moments of it, may be summed in single precision: not of a single size, of which
/// rounding alone is stated, nor of spheres so small that rounding would make their short series
/// several times as long.
/// @param tolerance  relative, of P
bool may_be_single(const Ensemble& ensemble, double tolerance);
/// P at the request's angles, with no less than the least errors that are stated; those of a single
/// size stay as they are.
PhaseValues with_stated_errors(PhaseValues values, const EnsembleRequest& request);
/// Puts such values where the optics have them.
void put_phase(PhaseValues values, const EnsembleRequest& request, EnsembleOptics& optics);

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

/// In a dark medium light scattered once prevails. Its error in R grows like 1/A^2 of the albedo A
/// of a half-space, so that the tolerance is multiplied by (A / kDark)^2, and by kLeastShare at
/// least.
struct DarkMedium {
    static constexpr double kDark = 0.2, kLeastShare = 1e-3;
};
/// The error of moments that the request wants, by what is known of the optics.
double wanted_error(const EnsembleRequest& request, const EnsembleOptics& optics);

}  // namespace miebrdf::mie
