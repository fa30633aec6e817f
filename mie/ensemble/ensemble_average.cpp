#include "mie/ensemble/ensemble_average.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "mie/ensemble/ensemble_change.h"
#include "mie/ensemble/exact_extinction.h"
#include "mie/ensemble/phase_tabulation.h"
#include "mie/sphere/terms.h"

namespace miebrdf::mie {
namespace {

using Rule = SizeRefinement::Rule;

// A band as wide as this costs as much as tabulating P; and how exact moments of that table are.
constexpr int least_table_moment = 200;
constexpr int safe_band_width = 64;
constexpr double least_table_tolerance = 1e-5;
constexpr double least_single_tolerance = 1e-7;  // single precision errs by 5e-9 (measured)
constexpr double rounding = 1e-13;               // no estimate below what rounding leaves

// What a size distribution without ends leaves out: well below what is asked of the result.
double tail_for(const EnsembleRequest& request) {
    const bool endless = request.sizes.kind == SizeDistributionKind::gamma ||
                         request.sizes.kind == SizeDistributionKind::log_normal;
    return endless ? std::clamp(0.02 * request.tolerance, 1e-16, 1e-6) : 0.0;
}

}  // namespace

EnsembleAverage::EnsembleAverage(const EnsembleRequest& request, const Executor& run)
    : request_(request),
      run_(run),
      relative_index_(relative_index_of(request)),
      wave_number_per_um_(wave_number_per_um(request)) {
    start();
    do {
        add_pass();
    } while (!optics_.converged && refinement_->refine());
    if (request_.with_phase_table || moments_from_table_) tabulate_phase();
}

void EnsembleAverage::start() {
    validate(request_);
    tail_ = tail_for(request_);
    range_ = tail_ > 0 ? radius_range(request_.sizes, tail_, 1 / wave_number_per_um_)
                       : radius_range(request_.sizes);
    share_ = area_share_within(request_.sizes, range_);
    const double smallest = wave_number_per_um_ * range_.smallest_um;
    const double largest = wave_number_per_um_ * range_.largest_um;
    if (!(smallest >= 1e-30 && largest <= 1e5)) {
        throw std::invalid_argument(fmt::format(
            "size parameters {} to {}; allowed for an ensemble: 1e-30 to 1e5", smallest, largest));
    }
    terms_ = number_of_terms(largest);
    moments_from_table_ = request_.highest_moment > std::max(least_table_moment, terms_ / 5) &&
                          request_.tolerance >= least_table_tolerance;
    if (!request_.angles_deg.empty()) angular_ = AngularFunctions(request_.angles_deg, terms_);
    if (request_.highest_moment >= 2) transform_.emplace(terms_, band_width(), run_);
    refinement_.emplace(request_.sizes, range_, relative_index_, wave_number_per_um_);
}

int EnsembleAverage::band_width() const {
    return moments_from_table_ ? safe_band_width : request_.highest_moment;
}

SizeSumOptions EnsembleAverage::sum_options() const {
    SizeSumOptions options;
    options.terms = terms_;
    if (request_.highest_moment >= 2) {  // chi_0 = 1 and chi_1 = g come free
        options.band_width = band_width();
    }
    options.single_precision =
        refinement_->rule() == Rule::even && request_.tolerance >= least_single_tolerance;
    if (angular_.angle_count() > 0) options.angles = &angular_;
    return options;
}

// One pass over more sizes, and what is known after it.
void EnsembleAverage::add_pass() {
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
    optics_.converged =
        optics_.error_estimate <= request_.tolerance &&
        (optics_.phase.empty() || optics_.phase_error_estimate <= request_.phase_tolerance);
}

void EnsembleAverage::prepare_even_rule() {
    // A table has no analytic continuation.
    if (exact_known_ || request_.sizes.kind == SizeDistributionKind::tabulated) return;
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
        o.chi = (*transform_)(sums.covariance, run_);
        const double whole = o.chi[0];
        for (double& chi : o.chi) chi /= whole;
    }
    for (const double intensity : sums.intensity) {
        o.phase.push_back(intensity / (2 * sums.spheres.scattered));
    }
    return o;
}

void EnsembleAverage::estimate_errors(const EnsembleOptics& before) {
    const double least = std::max(rounding, tail_);
    const bool single = refinement_->rule() == Rule::single;
    optics_.error_estimate = optics_.phase_error_estimate = single ? rounding : 1.0;
    if (single || refinement_->pass() == 0) return;
    const double absorption = change_by_absorption(before, optics_);
    const double change = std::max(largest_change(before, optics_), absorption);
    if (request_.sizes.kind == SizeDistributionKind::tabulated) {
        // Bends between the rows converge slowly, and there is no exact extinction to compare with.
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
    optics_.phase_error_estimate = std::max(phase_change(before, optics_), least);
}

// Extinction, and with it the albedo, need not carry the error of the nodes.
void EnsembleAverage::put_exact_extinction() {
    optics_.q_ext = exact_q_ext_;
    optics_.q_abs = std::min(optics_.q_abs, exact_q_ext_);
    optics_.q_sca = exact_q_ext_ - optics_.q_abs;
    optics_.one_minus_albedo = optics_.q_abs / optics_.q_ext;
    optics_.single_scattering_albedo = optics_.q_sca / optics_.q_ext;
}

void EnsembleAverage::tabulate_phase() {
    PhaseTabulationOptions options;
    options.interpolation_tolerance = request_.table_tolerance;
    options.size_tolerance = request_.phase_tolerance;
    options.floor = request_.phase_floor;
    options.scattering_efficiency = optics_.q_sca * share_;
    // Moments of the table shall not be worse than those of the band; many panels share the error.
    if (moments_from_table_) {
        options.first_moment = safe_band_width + 1;
        options.moment_tolerance = 0.08 * request_.tolerance;
    }
    PhaseTabulation tabulation(relative_index_, request_.sizes, range_, wave_number_per_um_,
                               options, run_);
    const auto table = std::make_shared<const PhaseTable>(tabulation.table());
    if (request_.with_phase_table) optics_.phase_table = table;
    if (!moments_from_table_) return;
    // Moments beyond 2 terms vanish: S1 and S2 are polynomials of degree terms.
    const int last = std::min(request_.highest_moment, 2 * terms_);
    const std::vector<double> chi = table->moments(last, run_);
    optics_.chi.insert(optics_.chi.end(), chi.begin() + safe_band_width + 1, chi.end());
    optics_.chi.resize(request_.highest_moment + 1, 0.0);
    optics_.error_estimate = std::max(optics_.error_estimate, tabulation.moment_error(last));
}

}  // namespace miebrdf::mie
