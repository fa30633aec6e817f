#include <miebrdf/ensemble.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include <miebrdf/error.h>
#include "mie/ensemble/ensemble_problem.h"
#include "mie/ensemble/exact_extinction.h"
#include "mie/ensemble/flushing.h"
#include "mie/ensemble/gauss_moments.h"
#include "mie/ensemble/optics_differences.h"
#include "mie/ensemble/phase_tabulation.h"
#include "mie/ensemble/ray_average.h"
#include "mie/ensemble/size_sums.h"
#include "mie/sphere/radial_functions.h"

namespace miebrdf::mie {
namespace {

using Rule = SizeRefinement::Rule;

// A band as wide as this costs as much as tabulating P; and how exact moments of that table are.
constexpr int kLeastTableMoment = 200;
constexpr int kSafeBandWidth = 64;
constexpr double kLeastTableTolerance = 1e-5;
// Moments at angles: their functions have 300 MB. Of larger spheres a table is as good as it gets.
constexpr int kMostTermsAtAngles = 3000;
constexpr double kMostProductsAtAngles = 1e11;  // a further pass is not begun beyond: 5 to 20 s
constexpr double kLeastSingleTolerance = 1e-7;  // single precision errs by 5e-9 (measured)
// Where a medium reflects little, P is what it reflects: its tolerance is this times what is enough
// where light scattered many times outshines P.
// Where ripple of large spheres makes that dear, only what may err everywhere alike is asked for.
constexpr double kDarkPhaseShare = 0.03;
constexpr double kFewWaves = 300;  // size parameter of the largest sphere
constexpr double kDark = 0.2;      // albedo of such a half-space
constexpr double kLeastDarkShare = 1e-3;
// Tables by rays: their bias is relative to max(P, 1/2), and a share of the tolerance.
constexpr double kLeastRayFloor = 0.25;
constexpr double kRayBiasShare = 0.25;
constexpr double kRounding = 1e-13;  // no estimate below what rounding leaves

// The average over sizes: passes of more sizes until the error estimate is met. Computes everything
// when it is made.
class EnsembleAverage {
  public:
    EnsembleAverage(const EnsembleRequest& request, const Executor& run);

    const EnsembleOptics& optics() const { return optics_; }

  private:
    void start();
    void choose_moments();
    bool take_rays();
    void prepare_even_rule();
    int band_width() const;
    SizeSumOptions sum_options() const;
    void add_pass();
    EnsembleOptics optics_of(const SizeSums& sums) const;
    void estimate_errors(const EnsembleOptics& before);
    bool is_enough() const;
    bool is_worth_more_sizes() const;
    void put_exact_extinction();
    void put_phase_table();
    void put_phase();

    EnsembleRequest request_;
    const Executor& run_;
    std::complex<double> relative_index_;
    double wave_number_per_um_;
    RadiusRange range_;
    double tail_ = 0;   // of the geometric cross-section, outside range_
    double share_ = 1;  // of it, inside
    int terms_ = 0;
    bool moments_from_table_ = false;
    std::optional<GaussMoments> at_angles_;  // where moments come from angles, and no table
    bool by_rays_ = false;
    std::optional<MomentTransform> transform_;  // the same for all passes
    std::optional<SizeRefinement> refinement_;
    SizeSums total_;  // all passes that count so far
    double change_before_ = 0, absorption_before_ = 0;
    bool exact_known_ = false;
    double exact_q_ext_ = 0;  // of the even rule
    EnsembleOptics optics_;
};

EnsembleAverage::EnsembleAverage(const EnsembleRequest& request, const Executor& run)
    : request_(request),
      run_(run),
      relative_index_(relative_index_of(request)),
      wave_number_per_um_(wave_number_per_um(request)) {
    start();
    if (!take_rays()) {
        do {
            add_pass();
        } while (!is_enough() && is_worth_more_sizes() && refinement_->refine());
    }
    if (!request_.angles_deg.empty()) put_phase();
    if (request_.with_phase_table || moments_from_table_) put_phase_table();
}

void EnsembleAverage::start() {
    validate(request_);
    tail_ = tail_for(request_);
    range_ = range_of(request_);
    share_ = area_share_within(request_.sizes, range_);
    const double smallest = wave_number_per_um_ * range_.smallest_um;
    const double largest = wave_number_per_um_ * range_.largest_um;
    if (!(smallest >= 1e-30 && largest <= 1e5)) {
        throw UsageError("size parameters", fmt::format("{} to {}", smallest, largest),
                         "1e-30 to 1e5 in an ensemble");
    }
    terms_ = number_of_terms(largest);
    choose_moments();
    require_angles(request_.angles_deg);
    refinement_.emplace(request_.sizes, range_, relative_index_, wave_number_per_um_);
}

// Few moments are sums over a band of products of partial waves, as wide as they are many; its
// transform takes the cube of that. A table of P that there is anyway has them for nothing.
void EnsembleAverage::choose_moments() {
    const int moments = request_.highest_moment;
    if (moments <= kLeastTableMoment) return;
    const bool is_wide = request_.with_phase_table || moments > terms_ / 5;
    if (request_.tolerance >= kLeastTableTolerance ? is_wide : terms_ > kMostTermsAtAngles) {
        moments_from_table_ = true;
    } else if (moments > terms_ / 2) {
        at_angles_.emplace(terms_, std::min(moments, 2 * terms_), run_);
    }
}

// Broad distributions of large rippling spheres: no sizes are sampled for their ripple.
bool EnsembleAverage::take_rays() {
    if (refinement_->rule() != Rule::even || at_angles_) return false;
    const auto rays =
        average_over_rays({relative_index_, request_.sizes, range_, share_, wave_number_per_um_},
                          band_width(), request_.tolerance, run_);
    if (!rays) return false;
    optics_ = *rays;
    optics_.error_estimate = std::max({optics_.error_estimate, kRounding, tail_});
    by_rays_ = is_enough();
    return by_rays_;
}

int EnsembleAverage::band_width() const {
    return moments_from_table_ ? kSafeBandWidth : request_.highest_moment;
}

SizeSumOptions EnsembleAverage::sum_options() const {
    SizeSumOptions options;
    options.terms = terms_;
    if (at_angles_) {
        options.angles = &at_angles_->angles();
    } else if (request_.highest_moment >= 2) {  // chi_0 = 1 and chi_1 = g come free
        options.band_width = band_width();
    }
    options.single_precision =
        refinement_->rule() == Rule::even && request_.tolerance >= kLeastSingleTolerance;
    return options;
}

// One pass over more sizes, and what is known after it.
void EnsembleAverage::add_pass() {
    if (request_.highest_moment >= 2 && !at_angles_ && !transform_)
        transform_.emplace(terms_, band_width());
    if (refinement_->rule() == Rule::even) prepare_even_rule();
    SizeSums sums =
        sum_over_sizes(relative_index_, WeightedSizes(refinement_->nodes(), wave_number_per_um_),
                       sum_options(), run_);
    if (refinement_->adds_to_passes_before()) {
        total_.add(sums);
        total_.scale(0.5);
    } else {
        total_ = std::move(sums);
    }
    const EnsembleOptics before = std::move(optics_);
    optics_ = optics_of(total_);
    optics_.size_nodes = refinement_->nodes_so_far();
    estimate_errors(before);
    if (exact_known_) put_exact_extinction();
    optics_.converged = optics_.error_estimate <= request_.tolerance;
}

// A half-space that reflects little is made of small differences of moments: for radiative transfer
// they are wanted better by the square of how dark it is.
bool EnsembleAverage::is_enough() const {
    double share = 1.0;
    if (request_.phase_floor > 0)
        share = std::clamp(std::pow(half_space_albedo(optics_) / kDark, 2), kLeastDarkShare, 1.0);
    return optics_.converged && optics_.error_estimate <= share * request_.tolerance;
}

bool EnsembleAverage::is_worth_more_sizes() const {
    if (!at_angles_) return true;
    const double products =
        4.0 * terms_ * at_angles_->angles().angle_count() * refinement_->nodes_so_far();
    return products <= kMostProductsAtAngles;
}

void EnsembleAverage::prepare_even_rule() {
    if (exact_known_ || !request_.sizes.kind.law().analytic) return;
    exact_q_ext_ =
        exact_extinction(relative_index_, request_.sizes, range_, wave_number_per_um_, run_) /
        share_;
    exact_known_ = exact_q_ext_ > 0;
}

EnsembleOptics EnsembleAverage::optics_of(const SizeSums& sums) const {
    EnsembleOptics o;
    o.q_sca = 2 * sums.spheres.scattered / share_;
    o.q_abs = 2 * sums.spheres.absorbed / share_;
    o.q_ext = o.q_sca + o.q_abs;
    o.one_minus_albedo = o.q_abs / o.q_ext;
    o.single_scattering_albedo = o.q_sca / o.q_ext;
    o.asymmetry = 2 * sums.spheres.asymmetric / sums.spheres.scattered;
    if (request_.highest_moment >= 0) o.chi.push_back(1.0);
    if (request_.highest_moment == 1) o.chi.push_back(o.asymmetry);
    if (request_.highest_moment >= 2) {
        o.chi = at_angles_ ? at_angles_->of(sums.intensity) : (*transform_)(sums.covariance, run_);
        o.chi.resize(std::size_t(band_width()) + 1, 0.0);
        const double whole = o.chi[0];
        for (double& chi : o.chi) chi /= whole;
    }
    return o;
}

void EnsembleAverage::estimate_errors(const EnsembleOptics& before) {
    const double least = std::max(kRounding, tail_);
    const bool single = refinement_->rule() == Rule::single;
    optics_.error_estimate = single ? kRounding : 1.0;
    if (single || refinement_->pass() == 0) return;
    const double absorption = change_by_absorption(before, optics_);
    const double change = std::max(largest_change(before, optics_), absorption);
    if (!request_.sizes.kind.law().analytic) {
        // Bends (between the rows of a table) converge slowly, and there is no exact extinction to
        // compare with.
        optics_.error_estimate = std::max(2 * change, least);
    } else if (refinement_->rule() == Rule::smooth) {
        // Gauss rules gain at least what they gained last time.
        const double gain = change_before_ > 0 ? std::min(1.0, change / change_before_) : 1.0;
        optics_.error_estimate = std::max(change * gain, least);
    } else {
        // Sampled against exact extinction tells which resonances the nodes have missed or hit too
        // hard. Over 336 transparent ensembles the error of the moments was below 2.0 times this in
        // 95 %.
        const double missed = exact_known_ ? std::abs(optics_.q_ext / exact_q_ext_ - 1) : change;
        // Resonances absorb, too, and the exact extinction does not tell which ones were missed:
        // two levels may agree by chance, so that the error is not believed to fall by more than
        // half.
        optics_.error_estimate =
            std::max({missed, change / 4, absorption, absorption_before_ / 2, least});
    }
    change_before_ = change;
    absorption_before_ = std::max(absorption, absorption_before_ / 2);
}

// Extinction, and with it the albedo, need not carry the error of the nodes.
void EnsembleAverage::put_exact_extinction() {
    optics_.q_ext = exact_q_ext_;
    optics_.q_abs = std::min(optics_.q_abs, exact_q_ext_);
    optics_.q_sca = exact_q_ext_ - optics_.q_abs;
    optics_.one_minus_albedo = optics_.q_abs / optics_.q_ext;
    optics_.single_scattering_albedo = optics_.q_sca / optics_.q_ext;
}

void EnsembleAverage::put_phase_table() {
    PhaseTabulationOptions options;
    const double damping =
        relative_index_.imag() * wave_number_per_um_ * effective_radius_of(request_.sizes);
    const bool is_cheap = damping > 1 || wave_number_per_um_ * range_.largest_um < kFewWaves;
    const double bright = request_.phase_floor > 0 && is_cheap ? half_space_albedo(optics_) : 1.0;
    const double relaxed = bright + (1 - bright) * kDarkPhaseShare;
    options.interpolation_tolerance = relaxed * request_.table_tolerance;
    options.size_tolerance = relaxed * request_.phase_tolerance;
    options.floor = bright * request_.phase_floor;
    options.scattering_efficiency = optics_.q_sca * share_;
    if (by_rays_) options.ray_bias = phase_ray_bias(problem_of(request_));
    options.by_rays = options.ray_bias.everywhere > 0 && options.floor >= kLeastRayFloor &&
                      options.ray_bias.typical() <= kRayBiasShare * options.size_tolerance;
    if (!options.by_rays) options.ray_bias = {};
    // Moments of the table shall not be worse than those of the band; many panels share the error.
    if (moments_from_table_) {
        options.first_moment = kSafeBandWidth + 1;
        // Moments beyond 2 terms vanish: S1 and S2 are polynomials of degree terms.
        options.last_moment = std::min(request_.highest_moment, 2 * terms_);
        options.moment_tolerance = 0.08 * request_.tolerance;
    }
    TabulatedPhase tabulated =
        tabulate_phase(relative_index_, request_.sizes, range_, wave_number_per_um_, options, run_);
    PhaseTable::Parts parts = tabulated.table.parts();
    parts.gave_moments = moments_from_table_;
    const auto table = std::make_shared<const PhaseTable>(PhaseTable(std::move(parts)));
    if (request_.with_phase_table) optics_.phase_table = table;
    if (!moments_from_table_) return;
    const std::vector<double> chi = table->moments(options.last_moment, run_);
    optics_.chi.insert(optics_.chi.end(), chi.begin() + kSafeBandWidth + 1, chi.end());
    optics_.chi.resize(request_.highest_moment + 1, 0.0);
    optics_.error_estimate = std::max(optics_.error_estimate, tabulated.moment_error);
}

void EnsembleAverage::put_phase() {
    PhaseValues values = phase_at_angles(request_, optics_.q_sca, run_);
    optics_.phase = std::move(values.phase);
    optics_.phase_error = std::move(values.error);
    for (std::size_t i = 0; i < optics_.phase.size(); ++i) {
        const double relative = optics_.phase_error[i] / optics_.phase[i];
        optics_.phase_error_estimate =
            std::max({optics_.phase_error_estimate, relative, kRounding});
        optics_.converged =
            optics_.converged &&
            (request_.phase_allowed.empty() ? relative <= request_.phase_tolerance
                                            : optics_.phase_error[i] <= request_.phase_allowed[i]);
    }
}

}  // namespace

PhaseValues phase_at_angles(const EnsembleRequest& request, double q_sca, const Executor& run) {
    validate(request);
    require_angles(request.angles_deg);
    const Executor pieces = flushing(run);
    const RadiusRange range = range_of(request);
    PhaseTabulationOptions options;
    options.size_tolerance = request.phase_tolerance;
    options.floor = request.phase_floor;
    options.most_work = request.phase_work;
    options.scattering_efficiency = q_sca * area_share_within(request.sizes, range);
    const EnsembleProblem problem = problem_of(request);
    options.ray_bias = phase_ray_bias(problem, true);
    options.by_rays = options.ray_bias.everywhere > 0;
    if (options.by_rays && !(q_sca > 0)) {
        const auto rays = average_over_rays(problem, 1, request.tolerance, pieces);
        if (rays) options.scattering_efficiency = rays->q_sca * problem.share;
    }
    return phase_at_angles(relative_index_of(request), request.sizes, range,
                           wave_number_per_um(request), options, request.angles_deg,
                           request.phase_allowed, pieces);
}

EnsembleOptics average_over_sizes(const EnsembleRequest& request, const Executor& run) {
    const Executor pieces = flushing(run);
    return EnsembleAverage(request, pieces).optics();
}

int highest_moment_of(const EnsembleRequest& request) {
    return 2 *
           number_of_terms(wave_number_per_um(request) * radius_range(request.sizes).largest_um);
}

}  // namespace miebrdf::mie
