#include "mie/ensemble/spheroid_average.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <utility>

#include <miebrdf/error.h>
#include "mie/ensemble/matrix_series.h"
#include "mie/ensemble/particle_ensemble.h"
#include "mie/ensemble/phase_table.h"
#include "mie/ensemble/size_refinement.h"
#include "mie/spheroid/orientation_average.h"
#include "mie/spheroid/t_matrix.h"
#include "rte/math/legendre.h"
#include "rte/math/matrix_series.h"

namespace miebrdf::mie {
namespace {

struct SpheroidRule {
    /// Of equally spaced ones: a T-matrix takes milliseconds.
    static constexpr int kMostSizes = 512;
    /// A T-matrix may err by the least error that is stated, but this is rounding.
    static constexpr double kLeastT = 1e-11;
    /// A T-matrix with a larger estimate has no digits left: its size is refused.
    static constexpr double kWorstT = 0.02;
    /// Measured on a Zen 4 core; right to a factor of three elsewhere.
    static constexpr double kSecondsPerDegree4 = 6e-8;
};

// The sums of one size, `products` the series as of matrix_series, whose first entry is q_sca.
SizeSums of_size(const Spheroid& spheroid, double tolerance) {
    const TMatrix T = t_matrix(spheroid, stated_error(SpheroidRule::kLeastT, tolerance));
    if (!(T.error_estimate <= SpheroidRule::kWorstT)) {
        throw UsageError(
            "size parameter of the larger axis of the spheroids",
            fmt::format("{:.4g}", spheroid.largest_x()),
            fmt::format("what the T-matrix keeps digits of with an aspect of {:.3g} and an index "
                        "of {:.3g} + {:.3g}i (docs/maths-spheroids.md: about 30 at an index of "
                        "1.5); for larger ones take the corrections for the shape (without "
                        "method=t-matrix), or a file of scattering",
                        spheroid.aspect, spheroid.relative_index.real(),
                        spheroid.relative_index.imag()));
    }
    const int degree = 2 * T.degree;
    const math::Quadrature rule = math::gauss_legendre(degree + 1);
    const Eigen::VectorXd cosines = Eigen::Map<const Eigen::VectorXd>(
        rule.nodes.data(), static_cast<Eigen::Index>(rule.nodes.size()));
    SizeSums sums;
    sums.products = math::matrix_series(orientation_average(T, cosines), rule, degree) /
                    std::pow(spheroid.size_parameter, 2);
    // As SphereSums: halves and a quarter of efficiencies.
    sums.spheres.scattered = 0.5 * sums.products(0, 0);
    sums.spheres.asymmetric = 0.25 * sums.products(1, 0);
    if (spheroid.relative_index.imag() > 0)
        sums.spheres.absorbed = std::max(0.0, 0.5 * T.q_ext - sums.spheres.scattered);
    sums.doubt = sums.spheres.scattered * T.error_estimate;
    return sums;
}

class SpheroidSummation : public SizeSummation {
  public:
    SpheroidSummation(const EnsembleRequest& request, const Ensemble& ensemble, const Executor& run)
        : request_(request), ensemble_(ensemble), run_(run) {}

    SizeSums sum(const SizeNodes& nodes, bool) const override {
        const std::size_t count = nodes.radius_um.size();
        std::vector<SizeSums> each(count);
        run_(int(count), [&](int job) {
            const auto i = std::size_t(job);
            const double x = ensemble_.wave_number_per_um * nodes.radius_um[i];
            each[i] = of_size({ensemble_.scatterer.relative_index, x, ensemble_.scatterer.aspect},
                              request_.tolerance);
            each[i].scale(nodes.area_share[i]);
            if (i % 2 == 0) each[i].every_other = each[i].spheres;
        });
        SizeSums sums;
        sums.products = Eigen::ArrayXXd::Zero(1, 6);
        for (const SizeSums& one : each) sums.add(one);
        return sums;
    }

    /// The series whose first entry is 1, degree by degree, so that longer ones go on.
    Eigen::ArrayXd averages(const SizeSums& sums) const override {
        return (sums.products / sums.products(0, 0)).transpose().reshaped();
    }

    double tolerance(const SphereSums&) const override { return request_.tolerance; }

  private:
    const EnsembleRequest& request_;
    const Ensemble& ensemble_;
    const Executor& run_;
};

class SpheroidAverage {
  public:
    SpheroidAverage(const EnsembleRequest& request, const Executor& run)
        : request_(request), ensemble_(ensemble_of(request)) {
        const SpheroidSummation summation(request, ensemble_, run);
        const RefinedAverage average =
            refine_sizes(ensemble_, summation, request.tolerance, SpheroidRule::kMostSizes);
        series_ = average.averages.reshaped(6, average.averages.size() / 6).transpose();
        if (average.change.size() > 0)
            change_ = average.change.reshaped(6, average.change.size() / 6).row(0);
        t_error_ =
            std::max(AverageLimits::kRounding, average.sums.doubt / average.sums.spheres.scattered);
        EnsembleOptics& o = result_.optics;
        o = efficiencies_of(average.sums.spheres, ensemble_.share);
        o.size_nodes = average.sizes;
        o.error_estimate = average.error_estimate + t_error_;
        o.converged = o.error_estimate <= request.tolerance;
        finish();
    }

    const MatrixOptics& result() const { return result_; }

  private:
    void finish() {
        put_series(series_, result_);
        EnsembleOptics& o = result_.optics;
        PhaseValues values;
        for (const double angle : request_.angles_deg) {
            const double x = cosine_of_scattering_angle(angle);
            values.phase.push_back(math::legendre_series(o.chi, x));
            values.error.push_back(phase_error(x));
        }
        put_phase(with_stated_errors(std::move(values), request_), request_, o);
        constexpr double floor = 1.0;
        const auto count = Eigen::Index(o.chi.size());
        const Eigen::ArrayXd angles =
            std::numbers::pi / double(count) *
            (Eigen::ArrayXd::LinSpaced(count, 0, double(count - 1)) + 0.5);
        const Eigen::ArrayXd noise = angles.cos().unaryExpr([&](double x) {
            return phase_error(x) / std::max(math::legendre_series(o.chi, x), floor);
        });
        o.phase_table = std::make_shared<const PhaseTable>(
            table_of_series(o.chi, noise, angles, floor, request_.tolerance));
    }

    // The change of P by the last doubling of sizes, and errors of all degrees by the T-matrix, of
    // either sign: the root of the sum of (2l + 1)^2 P_l^2, P_l^2 about 1 / (2l + 1).
    double phase_error(double x) const {
        const std::span<const double> change(change_.data(), std::size_t(change_.size()));
        const double of_sizes =
            ensemble_.law().single_size ? 0.0 : std::abs(math::legendre_series(change, x));
        return of_sizes + t_error_ * static_cast<double>(series_.rows());
    }

    const EnsembleRequest& request_;
    Ensemble ensemble_;
    Eigen::MatrixXd series_ = {};  // of the last sizes, whose first entry is 1
    Eigen::VectorXd change_ = {};  // of its moments, by the last doubling of sizes
    double t_error_ = 0;
    MatrixOptics result_;
};

}  // namespace

MatrixOptics average_spheroids(const EnsembleRequest& request, const Executor& run) {
    return SpheroidAverage(request, run).result();
}

double spheroid_seconds(const EnsembleRequest& request) {
    const Ensemble ensemble = ensemble_of(request);
    const double sizes = ensemble.law().single_size ? 1 : SizeRule::kFirstEven;
    const double x = ensemble.scatterer.outer_x(ensemble.largest_x());
    return sizes * SpheroidRule::kSecondsPerDegree4 * std::pow(x + 4 * std::cbrt(x) + 4, 4);
}

}  // namespace miebrdf::mie
