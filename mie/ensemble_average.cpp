#include "mie/ensemble_average.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "mie/exact_extinction.h"
#include "mie/moment_transform.h"
#include "mie/terms.h"

namespace miebrdf::mie {
namespace {

constexpr int sizes_per_block = 64;  // U and V of a block stay near the cache
constexpr int largest_chunk_count = 16;
constexpr double chunk_memory = 24e6;  // bytes, all bands of a pass together
constexpr int smooth_start = 16;       // nodes of the first pass where efficiencies are smooth
constexpr int smooth_limit = 256;      // more than this is for the even rule
constexpr double first_spacing = 3.4;  // of the even rule, in ripple periods; then half of it, ...
constexpr int node_limit = 1 << 16;
// A band as wide as this costs as much as tabulating P; and how exact moments of that table are.
constexpr int least_table_moment = 200;
constexpr int safe_band_width = 64;
constexpr double least_table_tolerance = 1e-5;
constexpr double rounding = 1e-13;  // no estimate below what rounding leaves

void validate(const EnsembleRequest& r) {
    if (!(r.host_index >= 0.1 && r.host_index <= 10)) {
        throw std::invalid_argument(fmt::format("host index {}; allowed: 0.1 to 10", r.host_index));
    }
    if (!(r.wavelength_nm > 0 && std::isfinite(r.wavelength_nm))) {
        throw std::invalid_argument(
            fmt::format("wavelength {} nm; allowed: positive and finite", r.wavelength_nm));
    }
    if (!(r.tolerance > 0 && r.tolerance < 1)) {
        throw std::invalid_argument(fmt::format("tolerance {}; allowed: (0, 1)", r.tolerance));
    }
    if (!(r.phase_tolerance > 0)) {
        throw std::invalid_argument(
            fmt::format("phase tolerance {}; allowed: above 0", r.phase_tolerance));
    }
    if (!(r.highest_moment >= -1 && r.highest_moment <= 100000)) {
        throw std::invalid_argument(
            fmt::format("highest moment {}; allowed: -1 (none) to 100000", r.highest_moment));
    }
    const double n = r.refractive_index.real(), k = r.refractive_index.imag();
    if (!(n / r.host_index >= 0.01 && n / r.host_index <= 100 && k >= 0 && k <= 1e3)) {
        throw std::invalid_argument(fmt::format(
            "refractive index {} + {}i; allowed: n/host in [0.01, 100], k in [0, 1000]", n, k));
    }
}

// What a size distribution without ends leaves out: well below what is asked of the result.
double tail_for(double tolerance) { return std::clamp(0.02 * tolerance, 1e-16, 1e-6); }

double largest_change(const EnsembleOptics& a, const EnsembleOptics& b) {
    double change = std::max({std::abs(a.q_ext / b.q_ext - 1),
                              std::abs(a.single_scattering_albedo / b.single_scattering_albedo - 1),
                              std::abs(a.asymmetry - b.asymmetry)});
    for (std::size_t l = 0; l < a.chi.size(); ++l) {
        change = std::max(change, std::abs(a.chi[l] - b.chi[l]));
    }
    return change;
}

}  // namespace

void EnsembleSums::add(const EnsembleSums& other) {
    spheres.scattered += other.spheres.scattered;
    spheres.absorbed += other.spheres.absorbed;
    spheres.asymmetric += other.spheres.asymmetric;
    if (covariance.width() >= 0) covariance.add(other.covariance);
    if (intensity.size() > 0) intensity += other.intensity;
}

void EnsembleSums::scale(double factor) {
    spheres.scattered *= factor;
    spheres.absorbed *= factor;
    spheres.asymmetric *= factor;
    covariance.scale(factor);
    intensity *= factor;
}

EnsembleAverage::EnsembleAverage(const EnsembleRequest& request)
    : request_(request), relative_index_(request.refractive_index / request.host_index) {
    validate(request);
    range_ = radius_range(request.sizes, tail_for(request.tolerance));
    const double largest = size_parameter(range_.largest_um);
    if (!(size_parameter(range_.smallest_um) >= 1e-30 && largest <= 1e5)) {
        throw std::invalid_argument(
            fmt::format("size parameters {} to {}; allowed for an ensemble: 1e-30 to 1e5",
                        size_parameter(range_.smallest_um), largest));
    }
    terms_ = number_of_terms(largest);
    moments_from_table_ = request.highest_moment > std::max(least_table_moment, terms_ / 5) &&
                          request.tolerance >= least_table_tolerance;
    if (!request.angles_deg.empty()) angular_ = AngularFunctions(request.angles_deg, terms_);
    rule_ = first_rule();
    switch (rule_) {
        case Rule::single:
            set_nodes({{range_.largest_um}, {1.0}});
            break;
        case Rule::smooth:
            set_nodes(smooth_size_nodes(request.sizes, range_, smooth_start));
            break;
        case Rule::even:
            start_even_rule();
            break;
    }
}

double EnsembleAverage::size_parameter(double radius_um) const {
    return 2 * std::numbers::pi * radius_um * request_.host_index / (request_.wavelength_nm * 1e-3);
}

// Resonances in size are as wide as k x at least: beyond 1, or for small spheres, nothing is
// narrow.
EnsembleAverage::Rule EnsembleAverage::first_rule() const {
    if (request_.sizes.kind == SizeDistributionKind::mono) return Rule::single;
    const double x_effective = size_parameter(effective_radius_of(request_.sizes));
    const bool damped = relative_index_.imag() * x_effective > 1;
    const bool small = size_parameter(range_.largest_um) < 3;
    return damped || small ? Rule::smooth : Rule::even;
}

// Transparent spheres repeat their ripple about every atan(s)/s in x, s^2 = n^2 - 1 (Chylek 1990,
// J. Opt. Soc. Am. A 7, 1609, eq. 1). A spacing just below a multiple of that sees the same
// resonances again and again; 0.85 times a power of two does not, and with 0.85 itself the error
// drops about tenfold (docs/maths-mie.md).
double EnsembleAverage::ripple_period() const {
    const double n = relative_index_.real();
    if (!(n > 1)) return 1;
    const double s = std::sqrt((n - 1) * (n + 1));
    return s > 1e-3 ? std::atan(s) / s : 1;
}

void EnsembleAverage::start_even_rule() {
    rule_ = Rule::even;
    pass_ = 0;
    // A table has no analytic continuation.
    const bool analytic = request_.sizes.kind != SizeDistributionKind::tabulated;
    exact_q_ext_ =
        analytic ? exact_extinction(relative_index_, request_.sizes, range_, size_parameter(1.0))
                 : 0;
    const double width = size_parameter(range_.largest_um) - size_parameter(range_.smallest_um);
    const double count = width / (first_spacing * ripple_period());
    even_count_ = static_cast<int>(std::clamp(count, 16.0, node_limit / 4.0));
    set_nodes(even_size_nodes(request_.sizes, range_, even_count_, 1.0));
}

void EnsembleAverage::set_nodes(SizeNodes nodes) {
    nodes_ = std::move(nodes);
    parameters_.clear();
    weights_.clear();
    for (std::size_t i = 0; i < nodes_.radius_um.size(); ++i) {
        const double x = size_parameter(nodes_.radius_um[i]);
        parameters_.push_back(x);
        weights_.push_back(nodes_.area_share[i] / x / x);
    }
    pass_sums_ = {};
}

int EnsembleAverage::chunk_count() const {
    if (tabulation_) return tabulation_->chunk_count();
    const int blocks =
        (static_cast<int>(parameters_.size()) + sizes_per_block - 1) / sizes_per_block;
    const double band_bytes = 2 * 8.0 * (terms_ + 1) * (std::max(band_width(), 0) + 1);
    const int fitting = std::max(4, static_cast<int>(chunk_memory / band_bytes));
    return std::min({blocks, largest_chunk_count, fitting});
}

EnsembleSums EnsembleAverage::compute(int chunk) const {
    const int size = static_cast<int>(parameters_.size());
    const int blocks = (size + sizes_per_block - 1) / sizes_per_block;
    const int chunks = chunk_count();
    if (!(chunk >= 0 && chunk < chunks)) {
        throw std::invalid_argument(fmt::format("chunk {}; allowed: 0 to {}", chunk, chunks - 1));
    }
    EnsembleSums sums;
    if (tabulation_) {
        sums.table = tabulation_->compute(chunk);
        return sums;
    }
    const bool with_moments = request_.highest_moment >= 2;  // chi_0 = 1 and chi_1 = g come free
    const bool with_angles = angular_.angle_count() > 0;
    if (with_moments) sums.covariance = BandCovariance(terms_, band_width());
    if (with_angles) sums.intensity = Eigen::MatrixXd::Zero(angular_.angle_count(), 2);
    SphereBlock block;
    for (int b = chunk * blocks / chunks; b < (chunk + 1) * blocks / chunks; ++b) {
        const int first = b * sizes_per_block;
        const int count = std::min(sizes_per_block, size - first);
        const std::span<const double> x(parameters_.data() + first, count);
        const std::span<const double> weight(weights_.data() + first, count);
        const bool with_waves = with_moments || with_angles;
        const SphereSums s =
            compute_spheres(relative_index_, x, weight, with_waves ? &block : nullptr);
        sums.spheres.scattered += s.scattered;
        sums.spheres.absorbed += s.absorbed;
        sums.spheres.asymmetric += s.asymmetric;
        if (with_moments) sums.covariance.add(block);
        if (with_angles) angular_.add_intensity(block, sums.intensity);
    }
    return sums;
}

void EnsembleAverage::merge(const EnsembleSums& chunk) {
    if (tabulation_) {
        tabulation_->merge(chunk.table);
    } else if (pass_sums_.spheres.scattered == 0) {
        pass_sums_ = chunk;
    } else {
        pass_sums_.add(chunk);
    }
}

EnsembleOptics EnsembleAverage::optics_of(const EnsembleSums& sums) const {
    EnsembleOptics o;
    o.q_sca = 2 * sums.spheres.scattered;
    o.q_abs = 2 * sums.spheres.absorbed;
    o.q_ext = o.q_sca + o.q_abs;
    o.one_minus_albedo = o.q_abs / o.q_ext;
    o.single_scattering_albedo = o.q_sca / o.q_ext;
    o.asymmetry = 2 * sums.spheres.asymmetric / sums.spheres.scattered;
    if (request_.highest_moment >= 0) o.chi.push_back(1.0);
    if (request_.highest_moment == 1) o.chi.push_back(o.asymmetry);
    if (request_.highest_moment >= 2) {
        o.chi = moments_from_covariance(sums.covariance);
        const double whole = o.chi[0];
        for (double& chi : o.chi) chi /= whole;
    }
    for (Eigen::Index i = 0; i < sums.intensity.rows(); ++i) {
        o.phase.push_back(sums.intensity.row(i).sum() / (2 * sums.spheres.scattered));
    }
    return o;
}

bool EnsembleAverage::finish_pass() {
    if (tabulation_) {
        if (tabulation_->finish_pass()) return true;
        finish_tabulation();
        return false;
    }
    const EnsembleOptics before = std::move(optics_);
    if (rule_ == Rule::even && pass_ > 0) {
        total_.add(pass_sums_);
        total_.scale(0.5);
    } else {
        total_ = std::move(pass_sums_);
    }
    optics_ = optics_of(total_);
    optics_.size_nodes = before.size_nodes + static_cast<int>(parameters_.size());
    estimate_errors(before);
    if (rule_ == Rule::even && exact_q_ext_ > 0) put_exact_extinction();
    optics_.converged =
        optics_.error_estimate <= request_.tolerance &&
        (optics_.phase.empty() || optics_.phase_error_estimate <= request_.phase_tolerance);
    if (!optics_.converged && rule_ != Rule::single && optics_.size_nodes < node_limit) {
        refine();
        return true;
    }
    if (wants_table()) start_tabulation();
    return wants_table();
}

void EnsembleAverage::estimate_errors(const EnsembleOptics& before) {
    if (rule_ == Rule::single) {
        optics_.error_estimate = optics_.phase_error_estimate = rounding;
        return;
    }
    optics_.error_estimate = optics_.phase_error_estimate = 1;
    if (pass_ == 0) return;
    const double change = largest_change(before, optics_);
    if (rule_ == Rule::smooth) {
        // Gauss rules gain at least what they gained last time.
        const double gain = change_before_ > 0 ? std::min(1.0, change / change_before_) : 1.0;
        optics_.error_estimate = std::max(change * gain, rounding);
    } else {
        // Sampled against exact extinction tells which resonances the nodes have missed or hit too
        // hard. Over 336 transparent ensembles the error of the moments was below 2.0 times this in
        // 95 %.
        const double missed =
            exact_q_ext_ > 0 ? std::abs(optics_.q_ext / exact_q_ext_ - 1) : change;
        optics_.error_estimate = std::max({missed, change / 4, rounding});
    }
    change_before_ = change;
    double phase_change = 0;
    for (std::size_t i = 0; i < optics_.phase.size(); ++i) {
        phase_change = std::max(phase_change, std::abs(before.phase[i] / optics_.phase[i] - 1));
    }
    optics_.phase_error_estimate = std::max(phase_change, rounding);
}

// Extinction, and with it the albedo, need not carry the error of the nodes.
void EnsembleAverage::put_exact_extinction() {
    optics_.q_ext = exact_q_ext_;
    optics_.q_abs = std::min(optics_.q_abs, exact_q_ext_);
    optics_.q_sca = exact_q_ext_ - optics_.q_abs;
    optics_.one_minus_albedo = optics_.q_abs / optics_.q_ext;
    optics_.single_scattering_albedo = optics_.q_sca / optics_.q_ext;
}

void EnsembleAverage::refine() {
    ++pass_;
    if (rule_ == Rule::even) {
        if (pass_ > 1) even_count_ *= 2;
        set_nodes(even_size_nodes(request_.sizes, range_, even_count_, 0.5));
        return;
    }
    const int count = smooth_start << pass_;
    if (count > smooth_limit) {
        change_before_ = 0;
        start_even_rule();
    } else {
        set_nodes(smooth_size_nodes(request_.sizes, range_, count));
    }
}

int EnsembleAverage::band_width() const {
    return moments_from_table_ ? safe_band_width : request_.highest_moment;
}

// Points of P interfere from size to size like exp(2i x): without ripple, a spacing of 0.8 resolves
// that. With ripple, 0.85 periods leave about 1e-2 of P (more in a glory), falling with the
// power 1.5.
void EnsembleAverage::start_tabulation() {
    SizeNodes nodes{{range_.largest_um}, {1.0}};
    if (rule_ != Rule::single) {
        const double width = size_parameter(range_.largest_um) - size_parameter(range_.smallest_um);
        const double finer = std::min(1.0, std::pow(request_.phase_tolerance / 1e-2, 1 / 1.5));
        const double spacing =
            rule_ == Rule::even ? 0.25 * first_spacing * ripple_period() * finer : 0.8;
        // Moments of the table shall not be worse than those of the band.
        const int so_far = rule_ == Rule::even && moments_from_table_ ? 2 * even_count_ : 0;
        const int wanted = std::max(static_cast<int>(width / spacing), so_far);
        const int count = std::clamp(wanted, 256, node_limit);
        nodes = even_size_nodes(request_.sizes, range_, count, 1.0);
    }
    set_nodes(std::move(nodes));
    tabulation_.emplace(relative_index_, parameters_, weights_, request_.table_tolerance);
}

void EnsembleAverage::finish_tabulation() {
    const auto table = std::make_shared<const PhaseTable>(tabulation_->table());
    if (request_.with_phase_table) optics_.phase_table = table;
    if (!moments_from_table_) return;
    // Moments beyond 2 terms vanish: S1 and S2 are polynomials of degree terms.
    const int last = std::min(request_.highest_moment, 2 * terms_);
    const std::vector<double> chi = table->moments(last);
    optics_.chi.insert(optics_.chi.end(), chi.begin() + safe_band_width + 1, chi.end());
    optics_.chi.resize(request_.highest_moment + 1, 0.0);
}

}  // namespace miebrdf::mie
