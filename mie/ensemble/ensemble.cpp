#include <miebrdf/ensemble.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include <miebrdf/error.h>
#include "mie/ensemble/adaptive_phase.h"
#include "mie/ensemble/moment_transform.h"
#include "mie/ensemble/particle_ensemble.h"
#include "mie/ensemble/ray_average.h"
#include "mie/ensemble/size_passes.h"
#include "mie/ensemble/spheroid_average.h"
#include "rte/math/quadrature.h"

namespace miebrdf::mie {
namespace {

using Rule = SizePasses::Rule;

// docs/internals/constants.md says what each constant does.
struct AverageRule {
    /// A table has moments as exact as this.
    static constexpr double kLeastTableTolerance = 1e-5;
    /// Partial waves beyond which moments are not summed at Gauss angles: their functions would
    /// take 300 MB, and a table is as good as it gets.
    static constexpr int kMostTermsAtAngles = 3000;
    /// Products in single precision change moments by 5e-9 (docs/maths-mie.md#average-over-sizes).
    static constexpr double kLeastSingleTolerance = 1e-7;
    /// Share of the tolerance of moments that a table may err by: its many panels add up.
    static constexpr double kTableShare = 0.08;
};

// A medium that reflects little reflects P itself, and moments matter by the square of how dark it
// is.
struct DarkMedium {
    static constexpr double kDark = 0.2;  ///< spherical albedo of a half-space
    static constexpr double kLeastShare = 1e-3;
    /// P is then wanted better, too, but not of spheres for which that would be dear: those of a
    /// larger size parameter than the first, which ripple, or than the second, where a table by
    /// sizes takes a second (and the cube of that).
    static constexpr double kFewWaves = 300, kFewDampedWaves = 2000;
};

// Tables by rays: their bias is a share of the tolerance.
struct RayTable {
    static constexpr double kBiasShare = 0.25;
};

/// Moments from the intensity at Gauss nodes in cos(angle), for ensembles whose bands of products
/// would be as wide as they are long. P has the degree 2 * terms, so that nothing but rounding is
/// lost; in double precision. Each size takes as many multiply-adds as 8 * terms * nodes, where a
/// band with all moments has twice as few, but takes terms^3 after each pass.
class GaussMoments {
  public:
    /// @param terms           partial waves of the largest sphere
    /// @param highest_moment  0 to 2 * terms
    GaussMoments(int terms, int highest_moment, const Executor& run)
        : highest_(highest_moment),
          rule_(math::gauss_legendre(terms + highest_moment / 2 + 1)),
          angles_(Eigen::Map<const Eigen::ArrayXd>(rule_.nodes.data(),
                                                   Eigen::Index(rule_.nodes.size())),
                  terms, run) {}

    const AngularFunctions& angles() const { return angles_; }
    /// chi_0 ... chi_highest from what the angles have summed, times an unknown factor.
    std::vector<double> of(const Eigen::VectorXd& intensity) const {
        const Eigen::Index count = intensity.size();
        const Eigen::Map<const Eigen::ArrayXd> x(rule_.nodes.data(), count);
        const Eigen::Map<const Eigen::ArrayXd> weights(rule_.weights.data(), count);
        const Eigen::ArrayXd values = weights * intensity.array();
        Eigen::ArrayXd before = Eigen::ArrayXd::Zero(count), here = Eigen::ArrayXd::Ones(count);
        std::vector<double> moments;
        for (int l = 0; l <= highest_; ++l) {
            moments.push_back((values * here).sum());
            before = ((2.0 * l + 1) / (l + 1.0)) * x * here - (l / (l + 1.0)) * before;
            before.swap(here);
        }
        return moments;
    }

  private:
    int highest_;
    math::Quadrature rule_;
    AngularFunctions angles_;
};

// Largest of the relative changes of extinction and albedo and the absolute ones of asymmetry and
// moments.
double largest_change(const EnsembleOptics& a, const EnsembleOptics& b) {
    double change = std::max({std::abs(a.q_ext / b.q_ext - 1),
                              std::abs(a.single_scattering_albedo / b.single_scattering_albedo - 1),
                              std::abs(a.asymmetry - b.asymmetry)});
    for (std::size_t l = 0; l < a.chi.size(); ++l)
        change = std::max(change, std::abs(a.chi[l] - b.chi[l]));
    return change;
}

// The change of the albedo of a half-space by a relative one of the absorption. A half-space of
// similar spheres has an albedo A with 1 - A about sqrt(6 (1 - omega) / (1 - omega g)):
// d(1 - A) = (1 - A)/2 d ln(1 - omega), at most 0.15.
double change_by_absorption(const EnsembleOptics& optics, double relative) {
    return relative * std::min(0.15, 0.5 * std::sqrt(6 * similar_absorption(optics)));
}

// The average over sizes: passes of more sizes until the error estimate is met. Computes everything
// when it is made.
class EnsembleAverage {
  public:
    EnsembleAverage(const EnsembleRequest& request, const Executor& run);

    const EnsembleOptics& optics() const { return optics_; }

  private:
    void choose_moments();
    bool take_rays();
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
    Ensemble ensemble_;
    double tail_;  // of the geometric cross-section, outside the range of sizes
    int terms_;
    SizePasses passes_;
    bool moments_from_table_ = false;
    std::optional<GaussMoments> at_angles_;     // where moments come from angles, and no table
    std::optional<MomentTransform> transform_;  // the same for all passes
    std::optional<RayAbsorption> absorption_;   // where sizes may miss resonances
    bool by_rays_ = false;                      // whether they do: absorption_ is better
    bool gains_nothing_ = false;                // more sizes do not
    EnsembleOptics optics_;
};

Ensemble valid_ensemble(const EnsembleRequest& request) {
    require_average(request);
    return ensemble_of(request);
}

EnsembleAverage::EnsembleAverage(const EnsembleRequest& request, const Executor& run)
    : request_(request),
      run_(run),
      ensemble_(valid_ensemble(request)),
      tail_(tail_for(request)),
      terms_(ensemble_.terms()),
      passes_(ensemble_) {
    choose_moments();
    if (!take_rays()) {
        if (passes_.rule() == Rule::even) absorption_ = absorption_by_rays(ensemble_, run_);
        do {
            add_pass();
        } while (!is_enough() && is_worth_more_sizes() && passes_.refine());
    }
    if (!request_.angles_deg.empty()) put_phase();
    if (request_.with_phase_table || moments_from_table_) put_phase_table();
}

// Few moments are sums over a band of products of partial waves, as wide as they are many; its
// transform takes the cube of that. A table of P that there is anyway has them for nothing.
void EnsembleAverage::choose_moments() {
    const int moments = request_.highest_moment;
    if (moments <= AverageLimits::kMostBandWidth) return;
    const bool is_wide = request_.with_phase_table || moments > terms_ / 5;
    if (request_.tolerance >= AverageRule::kLeastTableTolerance
            ? is_wide
            : terms_ > AverageRule::kMostTermsAtAngles) {
        moments_from_table_ = true;
    } else if (moments > terms_ / 2) {
        at_angles_.emplace(terms_, std::min(moments, 2 * terms_), run_);
    }
}

// Broad distributions of large rippling spheres: no sizes are sampled for their ripple.
bool EnsembleAverage::take_rays() {
    if (passes_.rule() != Rule::even || at_angles_) return false;
    const auto rays = average_over_rays(ensemble_, band_width(), request_.tolerance, run_);
    if (!rays) return false;
    optics_ = *rays;
    optics_.error_estimate = std::max({optics_.error_estimate, AverageLimits::kRounding, tail_});
    return is_enough();
}

int EnsembleAverage::band_width() const {
    return moments_from_table_ ? AverageLimits::kSafeBandWidth : request_.highest_moment;
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
        passes_.rule() == Rule::even && request_.tolerance >= AverageRule::kLeastSingleTolerance;
    return options;
}

// One pass over more sizes, and what is known after it.
void EnsembleAverage::add_pass() {
    if (request_.highest_moment >= 2 && !at_angles_ && !transform_)
        transform_.emplace(terms_, band_width());
    const EnsembleOptics before = std::move(optics_);
    optics_ = optics_of(passes_.add(sum_options(), run_));
    optics_.size_nodes = passes_.sizes_so_far();
    estimate_errors(before);
    if (passes_.exact_q_ext() > 0) put_exact_extinction();
    optics_.converged = optics_.error_estimate <= request_.tolerance;
}

// A half-space that reflects little is made of small differences of moments: for radiative transfer
// they are wanted better by the square of how dark it is.
bool EnsembleAverage::is_enough() const {
    double share = 1.0;
    if (request_.phase_floor > 0)
        share = std::clamp(std::pow(half_space_albedo(optics_) / DarkMedium::kDark, 2),
                           DarkMedium::kLeastShare, 1.0);
    return optics_.converged && optics_.error_estimate <= share * request_.tolerance;
}

bool EnsembleAverage::is_worth_more_sizes() const {
    // What is wanted for a dark medium beyond the tolerance is not worth sampling ripple.
    if (gains_nothing_ || (optics_.converged && passes_.ends_smooth())) return false;
    if (!at_angles_) return true;
    const double products =
        4.0 * terms_ * at_angles_->angles().angle_count() * passes_.sizes_so_far();
    return products <= AverageLimits::kMostProducts;
}

EnsembleOptics EnsembleAverage::optics_of(const SizeSums& sums) const {
    EnsembleOptics o;
    o.q_sca = 2 * sums.spheres.scattered / ensemble_.share;
    o.q_abs = 2 * sums.spheres.absorbed / ensemble_.share;
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
    const bool single = passes_.rule() == Rule::single;
    optics_.error_estimate = single ? AverageLimits::kRounding : 1.0;
    if (single || passes_.is_first()) return;
    double of_absorption = 0;
    if (before.one_minus_albedo > 0 && optics_.one_minus_albedo > 0)
        of_absorption = std::abs(std::log(before.one_minus_albedo / optics_.one_minus_albedo));
    const double of_sizes = of_absorption;
    by_rays_ = absorption_ && absorption_->error < of_absorption;
    if (by_rays_) of_absorption = absorption_->error;
    const double absorption = change_by_absorption(optics_, of_absorption);
    const double change = std::max(largest_change(before, optics_), absorption);
    // Sampled against exact extinction tells which resonances the sizes have missed or hit too
    // hard, but not what these absorb. Over 336 transparent ensembles the error of the moments was
    // below 2.0 times this in 95 %.
    const double exact = passes_.exact_q_ext();
    const double missed = exact > 0 ? std::abs(optics_.q_ext / exact - 1) : change;
    optics_.error_estimate =
        passes_.error(change, missed, 1.0, absorption, std::max(AverageLimits::kRounding, tail_));
    // Rays err by so much however many sizes there are, and sizes will not do better: what they
    // miss of resonances falls with their number.
    gains_nothing_ = by_rays_ && optics_.error_estimate <= absorption &&
                     of_sizes * passes_.sizes_so_far() > absorption_->error * kNodeLimit;
}

// Extinction, and with it the albedo, need not carry the error of the nodes.
void EnsembleAverage::put_exact_extinction() {
    optics_.q_ext = passes_.exact_q_ext();
    const double absorbed = by_rays_ ? absorption_->q_abs : optics_.q_abs;
    optics_.q_abs = std::min(absorbed, optics_.q_ext);
    optics_.q_sca = optics_.q_ext - optics_.q_abs;
    optics_.one_minus_albedo = optics_.q_abs / optics_.q_ext;
    optics_.single_scattering_albedo = optics_.q_sca / optics_.q_ext;
}

void EnsembleAverage::put_phase_table() {
    PhaseGoal goal;
    const bool ripples = ensemble_.ripples();
    const bool is_cheap =
        ensemble_.largest_x() < (ripples ? DarkMedium::kFewWaves : DarkMedium::kFewDampedWaves);
    const bool is_dark = request_.phase_floor > 0 && (is_cheap || !ripples);
    const double bright = is_dark ? half_space_albedo(optics_) : 1.0;
    const double relaxed = is_cheap ? std::max(bright, DarkMedium::kLeastShare) : 1.0;
    goal.interpolation_tolerance = relaxed * request_.table_tolerance;
    goal.size_tolerance = relaxed * request_.phase_tolerance;
    goal.floor = bright * request_.phase_floor;
    goal.scattering_efficiency = optics_.q_sca * ensemble_.share;
    // Rays without the ends of the sizes where what these leave would be too much.
    for (const auto method : {PhaseMethod::rays, PhaseMethod::exact_rays}) {
        const PhaseRayBias bias = phase_ray_bias(ensemble_, method == PhaseMethod::exact_rays);
        const double at_floor = std::max(1.0, PhaseRayBias::kFloor / goal.floor);
        if (goal.method != PhaseMethod::sizes || !(bias.everywhere > 0) ||
            !(at_floor * bias.typical() <= RayTable::kBiasShare * goal.size_tolerance))
            continue;
        goal.method = method;
        goal.ray_bias = bias;
    }
    if (moments_from_table_) {
        goal.first_moment = AverageLimits::kSafeBandWidth + 1;
        // Moments beyond 2 terms vanish: S1 and S2 are polynomials of degree terms.
        goal.last_moment = std::min(request_.highest_moment, 2 * terms_);
        goal.moment_tolerance = AverageRule::kTableShare * request_.tolerance;
    }
    TabulatedPhase tabulated = AdaptivePhase(ensemble_, goal, run_).table();
    PhaseTable::Parts parts = tabulated.table.parts();
    parts.gave_moments = moments_from_table_;
    const auto table = std::make_shared<const PhaseTable>(PhaseTable(std::move(parts)));
    if (request_.with_phase_table) optics_.phase_table = table;
    if (!moments_from_table_) return;
    if (goal.last_moment >= goal.first_moment) {  // else the band has them all
        const std::vector<double> chi = table->moments(goal.last_moment, run_);
        optics_.chi.insert(optics_.chi.end(), chi.begin() + goal.first_moment, chi.end());
    }
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
            std::max({optics_.phase_error_estimate, relative, AverageLimits::kRounding});
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
    if (request.aspect) {
        EnsembleOptics optics = average_spheroids(request, pieces).optics;
        return {std::move(optics.phase), std::move(optics.phase_error)};
    }
    const Ensemble ensemble = ensemble_of(request);
    PhaseGoal goal;
    goal.size_tolerance = request.phase_tolerance;
    goal.floor = request.phase_floor;
    goal.most_work = request.phase_work;
    goal.scattering_efficiency = q_sca * ensemble.share;
    goal.ray_bias = phase_ray_bias(ensemble, true);
    if (goal.ray_bias.everywhere > 0) goal.method = PhaseMethod::exact_rays;
    if (goal.method != PhaseMethod::sizes && !(q_sca > 0)) {
        const auto rays = average_over_rays(ensemble, 1, request.tolerance, pieces);
        if (rays) goal.scattering_efficiency = rays->q_sca * ensemble.share;
    }
    return AdaptivePhase(ensemble, goal, pieces).at(request.angles_deg, request.phase_allowed);
}

void require_average(const EnsembleRequest& request) {
    validate(request);
    require_angles(request.angles_deg);
    if (request.aspect) return;
    const Ensemble ensemble = ensemble_of(request);
    // Orders are those of the outermost shell.
    const double largest = ensemble.scatterer.outer_x(ensemble.largest_x());
    if (!(ensemble.smallest_x() >= 1e-30 && largest <= 1e5)) {
        throw UsageError("size parameters",
                         fmt::format("{} to {}{}", ensemble.smallest_x(), largest,
                                     largest > ensemble.largest_x() ? " with coatings" : ""),
                         "1e-30 to 1e5 in an ensemble");
    }
}

EnsembleOptics average_over_sizes(const EnsembleRequest& request, const Executor& run) {
    const Executor pieces = flushing(run);
    if (request.aspect) {
        require_average(request);
        EnsembleOptics optics = average_spheroids(request, pieces).optics;
        optics.chi.resize(static_cast<std::size_t>(request.highest_moment + 1));
        if (!request.with_phase_table) optics.phase_table = nullptr;
        return optics;
    }
    return EnsembleAverage(request, pieces).optics();
}

int highest_moment_of(const EnsembleRequest& request) {
    const Ensemble ensemble = ensemble_of(request);
    return 2 * ensemble.scatterer.terms(ensemble.wave_number_per_um *
                                        radius_range(request.sizes).largest_um);
}

}  // namespace miebrdf::mie
