#include <miebrdf/ensemble.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <utility>

#include <miebrdf/error.h>
#include "mie/ensemble/matrix_average.h"
#include "mie/ensemble/matrix_series.h"
#include "mie/ensemble/particle_ensemble.h"
#include "mie/ensemble/phase_table.h"
#include "mie/ensemble/size_passes.h"
#include "mie/ensemble/spheroid_average.h"
#include "rte/math/matrix_series.h"
#include "rte/math/quadrature.h"

namespace miebrdf::mie {
namespace {

using Rule = SizePasses::Rule;

// docs/internals/constants.md says what each constant does.
struct MatrixRule {
    /// Points of P have the errors of all degrees: their relative change counts for this much less
    /// than that of single degrees. Where P is below `phase_floor`, it is relative to that, which
    /// falls with what a half-space returns; without a floor to kDim.
    static constexpr double kPhasePerDegree = 10.0, kDim = 0.5;
    /// Noise of a panel is the rms over the nodes up to so many panels to both sides.
    static constexpr int kNoisePanels = 4;
};

// Products of partial waves, angles and sizes: real and imaginary part of two sums.
double products(int terms, int nodes, double sizes) { return 4.0 * terms * nodes * sizes; }

int all_degrees(int terms) { return 2 * terms; }

// Exact for the product of two amplitudes and a function of that degree.
int node_count(int terms, int degree) { return terms + degree / 2 + 1; }

// a1, a4, a2 + a3, a2 - a3, b1 and b2 at the nodes, from A = S1 + S2 and B = S1 - S2: |A|^2, |B|^2,
// Re A B*, Im A B*. (|A|^2 + |B|^2) / 4 = (|S1|^2 + |S2|^2) / 2, whose mean is half of `scattered`.
Eigen::MatrixXd elements(const Eigen::ArrayXXd& products, double scattered) {
    const double scale = 1.0 / (2.0 * scattered);
    const Eigen::ArrayXd sum = scale * products.col(0), difference = scale * products.col(1);
    Eigen::MatrixXd values(products.rows(), 6);
    values.col(0) = sum + difference;
    values.col(1) = sum - difference;
    values.col(2) = 2.0 * sum;
    values.col(3) = 2.0 * difference;
    values.col(4) = -2.0 * scale * products.col(2);
    values.col(5) = 2.0 * scale * products.col(3);
    return values;
}

// P on even panels.
// @param chi     of P
// @param noise   of P at `angles`, relative to max(P, floor); empty: none
// @param angles  radians, descending as the nodes of a rule in the cosine ascend
PhaseTable table_of(const std::vector<double>& chi, const Eigen::ArrayXd& noise,
                    const Eigen::ArrayXd& angles, double floor) {
    // One for half a period of the fastest wave that P has: eight nodes leave 1e-6 of it.
    const auto panels = static_cast<int>(chi.size());
    const double width = std::numbers::pi / panels;
    PhaseTable::Parts parts;
    for (int p = 0; p < panels; ++p) parts.edges.push_back(p * width);
    parts.edges.push_back(std::numbers::pi);
    const Eigen::MatrixXd values = series_on_panels(chi, parts.edges);
    for (int p = 0; p < panels && noise.size() > 0; ++p) {
        const double first = (p - MatrixRule::kNoisePanels) * width;
        const double last = (p + 1 + MatrixRule::kNoisePanels) * width;
        double squares = 0;
        int count = 0;
        for (Eigen::Index k = 0; k < noise.size(); ++k) {
            if (!(angles[k] >= first && angles[k] <= last)) continue;
            squares += noise[k] * noise[k];
            ++count;
        }
        parts.noise.push_back(std::sqrt(squares / std::max(count, 1)));
        parts.size_error = std::max(parts.size_error, parts.noise.back());
    }
    parts.noise_floor = floor;
    parts.gave_moments = true;
    return make_phase_table(std::move(parts), values);
}

class MatrixAverage {
  public:
    MatrixAverage(const EnsembleRequest& request, const Executor& run)
        : request_(request),
          run_(run),
          ensemble_(ensemble_of(request)),
          terms_(ensemble_.terms()),
          degree_(all_degrees(terms_)),
          passes_(ensemble_) {
        if (request.highest_moment >= 0) degree_ = std::min(degree_, request.highest_moment);
        rule_ = math::gauss_legendre(node_count(terms_, degree_));
    }

    MatrixOptics compute() {
        EnsembleRequest scalar = request_;
        scalar.highest_moment = -1;
        scalar.angles_deg.clear();
        scalar.with_phase_table = false;
        scalar.phase_floor = 0;
        result_.optics = average_over_sizes(scalar, run_);
        if (request_.phase_floor > 0)
            floor_ = half_space_albedo(result_.optics) * request_.phase_floor;
        const int nodes = static_cast<int>(rule_.nodes.size());
        const AngularFunctions angles(
            Eigen::Map<const Eigen::ArrayXd>(rule_.nodes.data(), Eigen::Index(nodes)), terms_,
            run_);
        do {
            add_pass(angles);
        } while (!(error_ <= request_.tolerance) &&
                 products(terms_, nodes, passes_.sizes_so_far()) <= AverageLimits::kMostProducts &&
                 passes_.refine());
        return finished();
    }

  private:
    void add_pass(const AngularFunctions& angles) {
        SizeSumOptions options;
        options.terms = terms_;
        options.angles = &angles;
        options.with_matrix = true;
        const SizeSums& sums = passes_.add(options, run_);
        const Eigen::MatrixXd before = std::move(rows_);
        const Eigen::MatrixXd here = elements(sums.products, sums.spheres.scattered);
        rows_ = math::matrix_series(here, rule_, degree_);
        const Eigen::ArrayXd phase = here.col(0);
        phase_change_ = {};
        if (phase_.size() > 0) phase_change_ = (phase - phase_) / phase.max(floor_);
        phase_ = phase;
        const double largest = phase_change_.size() > 0 ? phase_change_.abs().maxCoeff() : 0.0;
        estimate_error(before, largest, sums.spheres);
    }

    // The exact extinction tells which resonances the sizes have missed, as in EnsembleAverage.
    void estimate_error(const Eigen::MatrixXd& before, double phase_change,
                        const SphereSums& sums) {
        const bool single = passes_.rule() == Rule::single;
        error_ = single ? AverageLimits::kRounding : 1.0;
        if (single || passes_.is_first()) return;
        const double change =
            std::max(series_change(before, rows_), phase_change / MatrixRule::kPhasePerDegree);
        const double q_ext = 2 * (sums.scattered + sums.absorbed) / ensemble_.share;
        const double exact = passes_.exact_q_ext();
        const double missed = exact > 0 ? std::abs(q_ext / exact - 1) : change;
        error_ = passes_.error(change, missed, 0.5, 0.0,
                               std::max(AverageLimits::kRounding, tail_for(request_)));
    }

    MatrixOptics finished() {
        put_series(rows_, result_);
        EnsembleOptics& optics = result_.optics;
        const Eigen::Map<const Eigen::ArrayXd> x(rule_.nodes.data(),
                                                 Eigen::Index(rule_.nodes.size()));
        optics.phase_table = std::make_shared<const PhaseTable>(
            table_of(optics.chi, passes_.share_left() * phase_change_, x.acos(), floor_));
        optics.error_estimate = std::max(optics.error_estimate, error_);
        optics.size_nodes = std::max(optics.size_nodes, passes_.sizes_so_far());
        optics.converged = optics.converged && error_ <= request_.tolerance;
        return std::move(result_);
    }

    const EnsembleRequest& request_;
    const Executor& run_;
    Ensemble ensemble_;
    int terms_;
    int degree_;
    math::Quadrature rule_;
    SizePasses passes_;
    Eigen::MatrixXd rows_ = {};         // coefficients of a1, a4, a2, a3, b1, b2 without 2l + 1
    Eigen::ArrayXd phase_ = {};         // P at the nodes after the last pass
    Eigen::ArrayXd phase_change_ = {};  // by that pass, relative to max(P, floor_)
    double floor_ = MatrixRule::kDim;
    double error_ = 1;
    MatrixOptics result_;
};

}  // namespace

int matrix_nodes(int terms, int degree) { return node_count(terms, degree); }

Eigen::MatrixXd matrix_series_of(const Eigen::ArrayXXd& products, double scattered,
                                 const math::Quadrature& rule, int degree) {
    return math::matrix_series(elements(products, scattered), rule, degree);
}

double matrix_seconds(const EnsembleRequest& request) {
    if (request.aspect) return spheroid_seconds(request);
    const Ensemble ensemble = ensemble_of(request);
    const int terms = ensemble.terms();
    const SizePasses passes(ensemble);
    const bool is_single = passes.rule() == Rule::single;
    double sizes = passes.sizes_of_first_estimate();
    // Resonances of large spheres are met by chance: as many more sizes are taken as the tolerance
    // is smaller than what the first ones reach. Measured for size parameters of 100 to 570 at 2e-4
    // to 2e-3: .7 to 2.8 times this for clear spheres, .15 to .5 times for opaque ones.
    constexpr int fewest_terms = 60;
    constexpr double tolerance_of_first_sizes = 1e-2;
    if (!is_single && terms > fewest_terms)
        sizes *= std::max(1.0, tolerance_of_first_sizes / request.tolerance);
    int degree = all_degrees(terms);
    if (request.highest_moment >= 0) degree = std::min(degree, request.highest_moment);
    return products(terms, node_count(terms, degree), sizes) / AverageLimits::kProductsPerSecond;
}

void require_matrix(const EnsembleRequest& request) {
    validate(request);
    if (request.aspect) return;
    const double largest = ensemble_of(request).largest_x();
    if (largest <= kLargestMatrixSphere) return;
    throw UsageError(
        "size parameter with polarisation", fmt::format("{:.4g}", largest),
        fmt::format("up to {:g}; this would take {:.2g} s and {:.2g} GB, and change "
                    "the reflectance of unpolarised light by less than 0.3 %",
                    kLargestMatrixSphere, matrix_seconds(request), 16e-9 * largest * 2 * largest));
}

MatrixOptics average_matrix(const EnsembleRequest& request, const Executor& run) {
    require_matrix(request);
    const Executor pieces = flushing(run);
    if (request.aspect) {
        MatrixOptics spheroids = average_spheroids(request, pieces);
        if (request.highest_moment < 0) return spheroids;
        const auto count = static_cast<std::size_t>(request.highest_moment) + 1;
        const auto cut = [&](std::vector<double>& list) {
            list.resize(std::min(list.size(), count));
        };
        cut(spheroids.optics.chi);
        for (const auto& [name, list] : kMatrixLists) cut(spheroids.expansion.*list);
        return spheroids;
    }
    return MatrixAverage(request, pieces).compute();
}

}  // namespace miebrdf::mie
