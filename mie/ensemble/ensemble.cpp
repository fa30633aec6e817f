#include <miebrdf/ensemble.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include <miebrdf/error.h>
#include "mie/ensemble/adaptive_phase.h"
#include "mie/ensemble/moment_transform.h"
#include "mie/ensemble/particle_ensemble.h"
#include "mie/ensemble/phase_series.h"
#include "mie/ensemble/ray_average.h"
#include "mie/ensemble/size_refinement.h"
#include "mie/ensemble/spheroid_average.h"

namespace miebrdf::mie {
namespace {

// docs/internals/constants.md says what each constant does.
struct AverageRule {
    /// Partial waves beyond which moments are not summed at Gauss angles: their functions would
    /// take 300 MB, and a table is as good as it gets.
    static constexpr int kMostTermsAtAngles = 3000;
};

/// P of dark media is wanted better, but not of spheres for which that would be dear: those of a
/// larger size parameter.
struct DarkTable {
    static constexpr double kFewWaves = 300;
};

// Where moments come from. Few are sums over a band of products of partial waves, as wide as they
// are many; its transform takes the cube of that. A table of P that there is anyway has them for
// nothing, and nearly all of them are as cheap at Gauss angles.
enum class MomentSource { band, gauss_angles, table };

MomentSource moment_source(const EnsembleRequest& request, int terms) {
    const int moments = request.highest_moment;
    if (moments <= AverageLimits::kMostBandWidth) return MomentSource::band;
    const bool is_wide = request.with_phase_table || moments > terms / 5;
    const bool from_table = request.tolerance >= AverageLimits::kSingleError
                                ? is_wide
                                : terms > AverageRule::kMostTermsAtAngles;
    if (from_table) return MomentSource::table;
    return moments > terms / 2 ? MomentSource::gauss_angles : MomentSource::band;
}

// The width of the band: of moments from a table the first, which the band has better.
int band_width(const EnsembleRequest& request, MomentSource source) {
    return source == MomentSource::table ? AverageLimits::kSafeBandWidth : request.highest_moment;
}

// Efficiencies and moments of spheres.
class MomentSummation : public SizeSummation {
  public:
    MomentSummation(const EnsembleRequest& request, const Ensemble& ensemble, MomentSource source,
                    const Executor& run)
        : request_(request),
          ensemble_(ensemble),
          run_(run),
          terms_(ensemble.terms()),
          band_width_(band_width(request, source)) {
        if (source == MomentSource::gauss_angles) {
            at_angles_.emplace(terms_, std::min(request.highest_moment, 2 * terms_),
                               may_be_single(ensemble, request.tolerance), run);
        } else if (request.highest_moment >= 2) {  // chi_0 = 1 and chi_1 = g come free
            transform_.emplace(terms_, band_width_);
        }
        in_single_ = !is_smooth_in_size(ensemble) && !ensemble.law().single_size &&
                     request.tolerance >= AverageLimits::kLeastSingleTolerance;
    }

    SizeSums sum(const SizeNodes& nodes, bool all) const override {
        SizeSumOptions options;
        options.terms = terms_;
        if (all && at_angles_) options.angles = &at_angles_->angles();
        if (all && transform_) options.band_width = band_width_;
        options.single_precision = in_single_;
        return sum_over_sizes(ensemble_.scatterer,
                              WeightedSizes(nodes, ensemble_.wave_number_per_um), options, run_);
    }

    /// chi_0 = 1 ... of the band.
    Eigen::ArrayXd averages(const SizeSums& sums) const override {
        if (!at_angles_ && !transform_) return {};
        std::vector<double> chi =
            at_angles_ ? at_angles_->of(sums.intensity) : (*transform_)(sums.covariance, run_);
        chi.resize(std::size_t(band_width_) + 1, 0.0);
        return Eigen::Map<const Eigen::ArrayXd>(chi.data(), Eigen::Index(chi.size())) / chi[0];
    }

    double tolerance(const SphereSums& sums) const override {
        return wanted_error(request_, efficiencies_of(sums, ensemble_.share));
    }

    /// So many that time allows.
    int most_sizes() const {
        const int columns = at_angles_ ? int(at_angles_->cosines().size()) : band_width_ + 1;
        return int(std::min(double(SizeRule::kMostEven),
                            AverageLimits::kMostProducts / (4.0 * terms_ * std::max(1, columns))));
    }

  private:
    const EnsembleRequest& request_;
    const Ensemble& ensemble_;
    const Executor& run_;
    int terms_, band_width_;
    bool in_single_;
    std::optional<GaussMoments> at_angles_ = {};
    std::optional<MomentTransform> transform_ = {};
};

EnsembleOptics average_over_spheres(const EnsembleRequest& request, const Ensemble& ensemble,
                                    MomentSource source, const Executor& run) {
    const MomentSummation summation(request, ensemble, source, run);
    const RefinedAverage average =
        refine_sizes(ensemble, summation, request.tolerance, summation.most_sizes());
    EnsembleOptics optics = efficiencies_of(average.sums.spheres, ensemble.share);
    optics.size_nodes = average.sizes;
    optics.error_estimate = average.error_estimate;
    optics.converged = optics.error_estimate <= request.tolerance;
    optics.chi.assign(average.averages.begin(), average.averages.end());
    if (optics.chi.empty() && request.highest_moment >= 0) optics.chi = {1.0, optics.asymmetry};
    // The sums of g go on when those of moments have ended.
    if (request.highest_moment >= 1) optics.chi[1] = optics.asymmetry;
    if (request.highest_moment == 0) optics.chi.resize(1);
    return optics;
}

// Rays without the ends of the sizes where what these leave would be too much.
void choose_rays(const Ensemble& ensemble, PhaseGoal& goal) {
    for (const auto method : {PhaseMethod::rays, PhaseMethod::exact_rays}) {
        const PhaseRayBias bias = phase_ray_bias(ensemble, method == PhaseMethod::exact_rays);
        const double at_floor = std::max(1.0, AverageLimits::kDim / goal.floor);
        if (goal.method != PhaseMethod::sizes || !(bias.everywhere > 0) ||
            !(at_floor * bias.typical() <= AverageLimits::kPartShare * goal.size_tolerance))
            continue;
        goal.method = method;
        goal.ray_bias = bias;
    }
}

bool has_table_by_series(const EnsembleRequest& request, const Ensemble& ensemble) {
    if (!request.with_phase_table || !has_phase_series(ensemble)) return false;
    PhaseGoal goal;
    goal.size_tolerance = request.phase_tolerance;
    goal.floor = request.phase_floor;
    choose_rays(ensemble, goal);
    return goal.method == PhaseMethod::sizes;
}

void put_phase_table(const EnsembleRequest& request, const Ensemble& ensemble, MomentSource source,
                     const Executor& run, EnsembleOptics& optics) {
    const bool gives_moments = source == MomentSource::table;
    PhaseGoal goal;
    const bool is_cheap = ensemble.largest_x() < DarkTable::kFewWaves;
    const bool is_dark = request.phase_floor > 0 && (is_cheap || !ensemble.ripples());
    const double bright = is_dark ? half_space_albedo(optics) : 1.0;
    const double relaxed = is_cheap ? std::max(bright, DarkMedium::kLeastShare) : 1.0;
    goal.interpolation_tolerance = relaxed * request.table_tolerance;
    goal.size_tolerance = relaxed * request.phase_tolerance;
    goal.floor = bright * request.phase_floor;
    goal.most_work = AverageLimits::kMostProducts;
    goal.least_noise = stated_error(AverageLimits::kSingleError, request.tolerance);
    goal.scattering_efficiency = optics.q_sca * ensemble.share;
    choose_rays(ensemble, goal);
    if (gives_moments) {
        goal.first_moment = AverageLimits::kSafeBandWidth + 1;
        // Moments beyond 2 terms vanish: S1 and S2 are polynomials of degree terms.
        goal.last_moment = std::min(request.highest_moment, 2 * ensemble.terms());
        goal.moment_tolerance = AverageLimits::kPartShare * request.tolerance;
    }
    TabulatedPhase tabulated = AdaptivePhase(ensemble, goal, run).table();
    PhaseTable::Parts parts = tabulated.table.parts();
    parts.gave_moments = gives_moments;
    const auto table = std::make_shared<const PhaseTable>(PhaseTable(std::move(parts)));
    if (request.with_phase_table) optics.phase_table = table;
    if (!gives_moments) return;
    if (goal.last_moment >= goal.first_moment) {  // else the band has them all
        const std::vector<double> chi = table->moments(goal.last_moment, run);
        optics.chi.insert(optics.chi.end(), chi.begin() + goal.first_moment, chi.end());
    }
    optics.chi.resize(request.highest_moment + 1, 0.0);
    optics.error_estimate = std::max(optics.error_estimate, tabulated.moment_error);
}

PhaseValues phase_of_spheres(const EnsembleRequest& request, double q_sca, const Executor& run) {
    const Ensemble ensemble = ensemble_of(request);
    PhaseGoal goal;
    goal.size_tolerance = request.phase_tolerance;
    goal.floor = request.phase_floor;
    goal.most_work = request.phase_work;
    goal.scattering_efficiency = q_sca * ensemble.share;
    goal.ray_bias = phase_ray_bias(ensemble, true);
    if (goal.ray_bias.everywhere > 0) goal.method = PhaseMethod::exact_rays;
    if (goal.method == PhaseMethod::sizes && has_phase_series(ensemble) &&
        !ensemble.law().single_size)
        return phase_series_at_angles(request, ensemble, run);
    if (goal.method != PhaseMethod::sizes && !(q_sca > 0)) {
        const auto rays = average_over_rays(ensemble, 1, request.tolerance, run);
        if (rays) goal.scattering_efficiency = rays->q_sca * ensemble.share;
    }
    return AdaptivePhase(ensemble, goal, run).at(request.angles_deg, request.phase_allowed);
}

}  // namespace

PhaseValues phase_at_angles(const EnsembleRequest& request, double q_sca, const Executor& run) {
    validate(request);
    require_angles(request.angles_deg);
    const Executor pieces = flushing(run);
    if (!request.aspect)
        return with_stated_errors(phase_of_spheres(request, q_sca, pieces), request);
    EnsembleOptics optics = average_spheroids(request, pieces).optics;
    return {std::move(optics.phase), std::move(optics.phase_error)};
}

void require_average(const EnsembleRequest& request) {
    validate(request);
    require_angles(request.angles_deg);
    if (request.aspect) return;
    const Ensemble ensemble = ensemble_of(request);
    // Orders are those of the outermost shell.
    const double largest = ensemble.scatterer.outer_x(ensemble.largest_x());
    const double allowed = request.coatings.empty() ? kLargestInEnsemble : kLargestCoated;
    if (!(ensemble.smallest_x() >= 1e-30 && largest <= allowed)) {
        throw UsageError("size parameters",
                         fmt::format("{} to {}{}", ensemble.smallest_x(), largest,
                                     largest > ensemble.largest_x() ? " with coatings" : ""),
                         fmt::format("1e-30 to {:g} in an ensemble", allowed));
    }
}

EnsembleOptics average_over_sizes(const EnsembleRequest& request, const Executor& run) {
    require_average(request);
    const Executor pieces = flushing(run);
    if (request.aspect) {
        EnsembleOptics optics = average_spheroids(request, pieces).optics;
        optics.chi.resize(static_cast<std::size_t>(request.highest_moment + 1));
        if (!request.with_phase_table) optics.phase_table = nullptr;
        return optics;
    }
    const Ensemble ensemble = ensemble_of(request);
    const auto put_points = [&](EnsembleOptics& optics) {
        if (!request.angles_deg.empty())
            put_phase(phase_at_angles(request, optics.q_sca, run), request, optics);
    };
    if (has_table_by_series(request, ensemble)) {
        EnsembleOptics optics = average_phase_series(request, ensemble, pieces);
        put_points(optics);
        return optics;
    }
    const MomentSource source = moment_source(request, ensemble.terms());
    const auto rays = [&](double tolerance) {
        return average_over_rays(ensemble, band_width(request, source), tolerance, pieces);
    };
    std::optional<EnsembleOptics> optics;
    if (source != MomentSource::gauss_angles) optics = rays(request.tolerance);
    // Of a dark medium more is wanted, as is known now.
    const double wanted = optics ? wanted_error(request, *optics) : 0.0;
    if (optics && !(optics->error_estimate <= wanted)) optics = rays(wanted);
    if (optics) {
        optics->error_estimate = stated_error(optics->error_estimate, wanted);
    } else {
        optics = average_over_spheres(request, ensemble, source, pieces);
        // Rays may err by more than is wanted and still by less than all sizes that time allows.
        const bool may_take_rays = !optics->converged && source != MomentSource::gauss_angles &&
                                   request.tolerance >= kLeastToleranceOfRays;
        for (double within = 2 * request.tolerance;
             may_take_rays && !(optics->error_estimate <= within); within *= 2) {
            auto by_rays = rays(within);
            if (!by_rays) continue;
            optics = std::move(by_rays);
            optics->converged = false;
            break;
        }
    }
    put_points(*optics);
    if (request.with_phase_table || source == MomentSource::table)
        put_phase_table(request, ensemble, source, pieces, *optics);
    return *std::move(optics);
}

int highest_moment_of(const EnsembleRequest& request) {
    const Ensemble ensemble = ensemble_of(request);
    return 2 * ensemble.scatterer.terms(ensemble.wave_number_per_um *
                                        radius_range(request.sizes).largest_um);
}

}  // namespace miebrdf::mie
