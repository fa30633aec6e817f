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
#include "mie/ensemble/size_refinement.h"
#include "mie/ensemble/spheroid_average.h"
#include "rte/math/matrix_series.h"
#include "rte/math/quadrature.h"

namespace miebrdf::mie {
namespace {

// docs/internals/constants.md says what each constant does.
struct MatrixRule {
    /// Points of P have the errors of all degrees: their relative change counts for this much less
    /// than that of single degrees. Where P is below `phase_floor`, it is relative to that, which
    /// falls with what a half-space returns; without a floor to AverageLimits::kDim.
    static constexpr double kPhasePerDegree = 10.0;
};

// Products of partial waves, angles and sizes: real and imaginary part of two sums.
double products(int terms, int nodes, double sizes) { return 4.0 * terms * nodes * sizes; }

int degree_of(const EnsembleRequest& request, int terms) {
    const int all = 2 * terms;
    return request.highest_moment >= 0 ? std::min(all, request.highest_moment) : all;
}

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

// Amplitudes of spheres at Gauss nodes, and the series of their products.
class MatrixSummation : public SizeSummation {
  public:
    MatrixSummation(const EnsembleRequest& request, const Ensemble& ensemble, const Executor& run)
        : request_(request),
          ensemble_(ensemble),
          run_(run),
          terms_(ensemble.terms()),
          degree_(degree_of(request, terms_)),
          rule_(math::gauss_legendre(node_count(terms_, degree_))),
          angles_(
              angular_tables(cosines(), terms_, may_be_single(ensemble, request.tolerance), run)) {}

    SizeSums sum(const SizeNodes& nodes, bool all) const override {
        SizeSumOptions options;
        options.terms = terms_;
        options.angles = all ? &angles_ : nullptr;
        options.with_matrix = all;
        return sum_over_sizes(ensemble_.scatterer,
                              WeightedSizes(nodes, ensemble_.wave_number_per_um), options, run_);
    }

    /// The coefficients of a1, a4, a2, a3, b1, b2 without 2l + 1, column by column, and P at the
    /// nodes.
    Eigen::ArrayXd averages(const SizeSums& sums) const override {
        const Eigen::MatrixXd here = elements(sums.products, sums.spheres.scattered);
        const Eigen::MatrixXd series = math::matrix_series(here, rule_, degree_);
        Eigen::ArrayXd all(series.size() + here.rows());
        all << series.reshaped().array(), here.col(0).array();
        return all;
    }

    double size_of(const Eigen::ArrayXd& change, const Eigen::ArrayXd& averages,
                   const SphereSums& sums) const override {
        const double of_series = change.head(change.size() - nodes()).abs().maxCoeff();
        if (std::isinf(request_.phase_tolerance)) return of_series;
        const Eigen::ArrayXd relative =
            change.tail(nodes()) / averages.tail(nodes()).max(dim_phase(sums));
        return std::max(of_series, relative.abs().maxCoeff() / MatrixRule::kPhasePerDegree);
    }

    double tolerance(const SphereSums&) const override { return request_.tolerance; }

    int most_sizes() const {
        return int(std::min(double(SizeRule::kMostEven),
                            AverageLimits::kMostProducts / products(terms_, int(nodes()), 1)));
    }

    MatrixOptics result(const RefinedAverage& average) const {
        MatrixOptics result;
        EnsembleOptics& optics = result.optics;
        optics = efficiencies_of(average.sums.spheres, ensemble_.share);
        optics.size_nodes = average.sizes;
        optics.error_estimate = average.error_estimate;
        optics.converged = optics.error_estimate <= request_.tolerance;
        const Eigen::Index series = average.averages.size() - nodes();
        put_series(average.averages.head(series).reshaped(degree_ + 1, 6).matrix(), result);
        const double dim = dim_phase(average.sums.spheres);
        Eigen::ArrayXd noise;
        if (average.change.size() > 0)
            noise = average.change.tail(nodes()) / average.averages.tail(nodes()).max(dim);
        optics.phase_table = std::make_shared<const PhaseTable>(
            table_of_series(optics.chi, noise, cosines().acos(), dim, request_.tolerance));
        return result;
    }

  private:
    Eigen::Map<const Eigen::ArrayXd> cosines() const { return {rule_.nodes.data(), nodes()}; }
    Eigen::Index nodes() const { return Eigen::Index(rule_.nodes.size()); }
    /// P below this errs relative to it.
    double dim_phase(const SphereSums& sums) const {
        if (!(request_.phase_floor > 0)) return AverageLimits::kDim;
        return request_.phase_floor * half_space_albedo(efficiencies_of(sums, 1.0));
    }

    const EnsembleRequest& request_;
    const Ensemble& ensemble_;
    const Executor& run_;
    int terms_, degree_;
    math::Quadrature rule_;
    AngularTables angles_;
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
    // Resonances of large spheres are met by chance: as many more sizes are taken as the tolerance
    // is smaller than what the first ones reach. Measured for size parameters of 100 to 570 at 2e-4
    // to 2e-3: .7 to 2.8 times this for clear spheres.
    constexpr int fewest_terms = 60;
    constexpr double tolerance_of_first_sizes = 1e-2;
    double sizes = is_smooth_in_size(ensemble) ? 3 * SizeRule::kFirstGauss : SizeRule::kFirstEven;
    if (ensemble.law().single_size) sizes = 1;
    if (sizes == SizeRule::kFirstEven && terms > fewest_terms)
        sizes *= std::max(1.0, tolerance_of_first_sizes / request.tolerance);
    return products(terms, node_count(terms, degree_of(request, terms)), sizes) /
           AverageLimits::kProductsPerSecond;
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
    const Ensemble ensemble = ensemble_of(request);
    const MatrixSummation summation(request, ensemble, pieces);
    return summation.result(
        refine_sizes(ensemble, summation, request.tolerance, summation.most_sizes()));
}

}  // namespace miebrdf::mie
