#include "mie/ensemble/ray_average.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>

#include "mie/ensemble/ray_moments.h"
#include "mie/sizes/size_nodes.h"
#include "mie/sphere/lane_math.h"
#include "mie/sphere/radial_functions.h"

namespace miebrdf::mie {
namespace {

// Each was found over random ensembles, against sums over spheres (tests/mie/rays_test.cpp;
// docs/internals/mie-log.md#rays).
// docs/internals/constants.md says what each constant does.
struct RayRule {
    /// The wave through the middle of a sphere is behind the diffracted one by rho = 2 x (n - 1).
    /// Where that is less than about one turn there is nothing to average (anomalous diffraction).
    static constexpr double kLeastDelay = 10, kLeastIndex = 1.05;
    /// A Gaussian spread of rho would leave exp(-rho^2 v / 2).
    static constexpr double kPerSpread = 7;
    /// Moments err by up to 1.2 times what sharp ends change the extinction by, more where both
    /// ends happen to cancel there; a quarter of their bound is left at least.
    static constexpr double kPerChange = 3, kLeastOfEnds = 0.25;
    /// Moments from 16 Gauss sizes: what they leave of the light reflected near the edge, and of
    /// high orders of small spheres; it falls with the number of sizes.
    static constexpr int kSizes = 16, kMostSizes = 128;
    static constexpr double kError = 2.5e-5, kErrorOfHighMoments = 8e-4;
    /// Sizes for what is absorbed, which is smooth in size.
    static constexpr int kSizesOfAbsorption = 64;
};

struct PhaseRayRule {
    /// Bias of P, times 1/x: everywhere, and relative to phase_of_ends().
    static constexpr double kBias = 0.005, kEndsBias = 1.5;
    /// Below this index bright rays of p and p + 1 ways are of one length at some angle, and
    /// coherent: ways p (m - s) > 1 + s, s^2 = m^2 - 1, that is p = 4 at 1.25, 6 at 1.46, 18
    /// at 2.6.
    static constexpr double kCrossingIndex = 1.4, kCrossingBias = 0.5, kExactCrossingBias = 1.5;
    static constexpr double kLargestBound = 1e-3;
};

// What sharp ends of the sizes change the extinction by: light through the middle of a sphere
// interferes with diffracted light, Q = -8/x Im B exp(2i (m - 1) x), B = m^2 / ((m + 1) (m^2 - 1))
// (Nussenzveig & Wiscombe 1980), integrated by parts.
double extinction_of_ends(const Ensemble& ensemble) {
    if (!ensemble.law().has_ends) return 0;
    using Complex = std::complex<double>;
    const Complex m = ensemble.scatterer.relative_index, turns = Complex(0, 2) * (m - 1.0);
    const auto density = area_density(ensemble.sizes);
    const auto at = [&](double radius_um) {
        const double x = ensemble.wave_number_per_um * radius_um;
        return density->at(radius_um) / ensemble.wave_number_per_um / x * std::exp(turns * x);
    };
    const Complex ends = at(ensemble.range.largest_um) - at(ensemble.range.smallest_um);
    return -8 * (m * m / ((m + 1.0) * (m * m - 1.0)) / turns * ends).imag() / ensemble.share;
}

double rule_error(double x_effective, int highest_moment, int sizes) {
    const double fineness = std::max(highest_moment, 1) / x_effective;
    return (RayRule::kError + RayRule::kErrorOfHighMoments * fineness * fineness) *
           RayRule::kSizes / sizes;
}

// The share of the area per x at both ends (sharp ones), summed in squares, over the rate at which
// phases of rays of p and p + 1 ways part with x.
double phase_of_ends(const Ensemble& ensemble) {
    if (!ensemble.law().has_ends) return 0;
    const auto density = area_density(ensemble.sizes);
    const double k = ensemble.wave_number_per_um;
    const double at_ends =
        std::hypot(density->at(ensemble.range.smallest_um), density->at(ensemble.range.largest_um));
    return at_ends / (k * ensemble.share) / (2 * (ensemble.scatterer.n() - 1));
}

// The share, averaged over areas, that absorption leaves of light on so many ways through spheres.
// No way is shorter than that of light which enters at the edge.
double left_by_absorption(const Ensemble& ensemble, double ways) {
    if (!ensemble.scatterer.absorbs()) return 1;
    const double m = ensemble.scatterer.n(), shortest = std::sqrt((m - 1) * (m + 1)) / m;
    const SizeNodes nodes =
        smooth_size_nodes(ensemble.sizes, ensemble.range, RayRule::kSizesOfAbsorption);
    double left = 0, whole = 0;
    for (std::size_t i = 0; i < nodes.radius_um.size(); ++i) {
        const double x = ensemble.wave_number_per_um * nodes.radius_um[i];
        left +=
            nodes.area_share[i] * std::exp(-2 * ways * shortest * ensemble.scatterer.damping(x));
        whole += nodes.area_share[i];
    }
    return left / whole;
}

}  // namespace

RayBound ray_bound(const Ensemble& ensemble) {
    constexpr double never = std::numeric_limits<double>::infinity();
    const SizeLaw& law = ensemble.law();
    const double n = ensemble.scatterer.n();
    const double x = ensemble.wave_number_per_um * effective_radius_of(ensemble.sizes);
    if (law.single_size || !law.is_without_bends || !(n >= RayRule::kLeastIndex) ||
        !ensemble.scatterer.has_rays()) {
        return {never, never};
    }
    RayBound bound;
    const double delay_per_x = 2 * (n - 1);
    const double smallest = ensemble.wave_number_per_um * ensemble.range.smallest_um;
    const double largest = ensemble.wave_number_per_um * ensemble.range.largest_um;
    if (law.has_ends) {
        // Q_ext = 2 - 4/rho sin(rho) of anomalous diffraction, integrated by parts: what its ends
        // leave, each with the density there.
        const auto density = area_density(ensemble.sizes);
        for (const double at : {smallest, largest}) {
            const double per_x =
                density->at(at / ensemble.wave_number_per_um) / ensemble.wave_number_per_um;
            bound.ends += per_x * 2 / (delay_per_x * delay_per_x * at);
        }
        bound.spread = smallest * delay_per_x < RayRule::kLeastDelay ? never : 0;
    } else {
        RadiusRange waves = ensemble.range;
        waves.smallest_um =
            std::clamp(RayRule::kLeastDelay / delay_per_x / ensemble.wave_number_per_um,
                       waves.smallest_um, waves.largest_um);
        const double in_step = 1 - area_share_within(ensemble.sizes, waves) / ensemble.share;
        bound.spread = 3 * std::max(in_step, 0.0);
    }
    const double turned = delay_per_x * x;
    bound.spread +=
        std::exp(-turned * turned * ensemble.sizes.effective_variance / RayRule::kPerSpread);
    return bound;
}

PhaseRayBias phase_ray_bias(const Ensemble& ensemble, bool exact) {
    const RayBound bound = ray_bound(ensemble);
    const double k = ensemble.wave_number_per_um;
    const double index = ensemble.scatterer.n();
    if (!(bound.total() <= PhaseRayRule::kLargestBound)) return {};
    const double x = k * effective_radius_of(ensemble.sizes);
    const double s = std::sqrt((index - 1) * (index + 1)), ways = (1 + s) / (index - s);
    const double crossing =
        (exact ? PhaseRayRule::kExactCrossingBias : PhaseRayRule::kCrossingBias) / x *
        left_by_absorption(ensemble, 2 * ways + 1);
    const double apart = PhaseRayRule::kBias / x + bound.spread;
    if (index < PhaseRayRule::kCrossingIndex && crossing > apart) return {crossing};
    if (exact) return {apart};
    return {apart,
            PhaseRayRule::kEndsBias * phase_of_ends(ensemble) * left_by_absorption(ensemble, 1)};
}

std::optional<EnsembleOptics> average_over_rays(const Ensemble& ensemble, int highest_moment,
                                                double tolerance, const Executor& run) {
    if (!(tolerance >= kLeastToleranceOfRays)) return std::nullopt;
    const RayBound bound = ray_bound(ensemble);
    const double k = ensemble.wave_number_per_um;
    const double x = k * effective_radius_of(ensemble.sizes);
    if (!(bound.spread <= tolerance)) return std::nullopt;
    const double of_ends = extinction_of_ends(ensemble);
    const double known = bound.spread + std::max(RayRule::kPerChange * std::abs(of_ends) / 2,
                                                 RayRule::kLeastOfEnds * bound.ends);
    const double of_rays = std::min(known, bound.total());
    if (!(of_rays <= tolerance)) return std::nullopt;

    int size_count = RayRule::kSizes;
    const double ratio = ensemble.range.largest_um / ensemble.range.smallest_um;
    while (size_count < 4 * std::log(ratio)) size_count += kLaneCount;
    while (!(rule_error(x, highest_moment, size_count) + bound.spread <= 0.5 * tolerance) &&
           size_count < RayRule::kMostSizes) {
        size_count *= 2;
    }
    const double of_rule = rule_error(x, highest_moment, size_count);
    if (!(of_rule + of_rays <= tolerance)) return std::nullopt;

    EnsembleOptics optics;
    optics.error_estimate = of_rule + of_rays;
    const int terms = number_of_terms(k * ensemble.range.largest_um);
    const MomentTransform transform(terms, std::max(highest_moment, 1));
    const WeightedSizes sizes(smooth_size_nodes(ensemble.sizes, ensemble.range, size_count), k);
    const RaySums sums = sum_over_rays(ensemble.scatterer.relative_index, sizes, transform, run);
    optics.q_ext = 2 * sums.extinguished / ensemble.share + of_ends;
    optics.q_abs = 2 * sums.absorbed / ensemble.share;
    optics.q_sca = optics.q_ext - optics.q_abs;
    optics.one_minus_albedo = optics.q_abs / optics.q_ext;
    optics.single_scattering_albedo = optics.q_sca / optics.q_ext;
    optics.size_nodes = size_count;
    optics.chi = transform(sums.collected, run);
    const double whole = optics.chi[0];
    for (double& chi : optics.chi) chi /= whole;
    optics.asymmetry = optics.chi[1];
    optics.chi.resize(std::max(highest_moment + 1, 0));
    optics.converged = true;
    return optics;
}

}  // namespace miebrdf::mie
