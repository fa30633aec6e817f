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
#include "mie/sizes/size_nodes.h"
#include "mie/spheroid/orientation_average.h"
#include "mie/spheroid/t_matrix.h"
#include "rte/math/legendre.h"
#include "rte/math/matrix_series.h"

namespace miebrdf::mie {
namespace {

struct SpheroidRule {
    static constexpr int kFirstSizes = 6, kMostSizes = 384;
    /// In all passes, at a tolerance of 2e-4: 42 to 190 where n is 1.5.
    static constexpr double kTypicalSizes = 90;
    /// Share of the tolerance that a T-matrix may err by.
    static constexpr double kTShare = 0.1, kLeastT = 1e-11;
    /// A T-matrix with a larger estimate has no digits left: its size is refused.
    static constexpr double kWorstT = 0.02;
    /// A panel of a phase table may hold this many radians of the highest degree: eight nodes err
    /// by 1e-6 of the wave then.
    static constexpr double kPanelWaves = 3.0;
    static constexpr int kFewestPanels = 16;
    /// Measured on a Zen 4 core; right to a factor of three elsewhere.
    static constexpr double kSecondsPerDegree4 = 6e-8;
};

// Sums over sizes: series as of matrix_series, whose first entry is q_sca.
struct Sums {
    double extinction = 0, error = 0;
    Eigen::MatrixXd series = Eigen::MatrixXd::Zero(1, 6);

    double scattering() const { return series(0, 0); }
    void add(const Sums& other, double weight) {
        extinction += weight * other.extinction;
        error += weight * other.scattering() * other.error;
        if (other.series.rows() > series.rows()) {
            const auto before = series.rows();
            series.conservativeResize(other.series.rows(), 6);
            series.bottomRows(series.rows() - before).setZero();
        }
        series.topRows(other.series.rows()) += weight * other.series;
    }
};

Sums of_size(const Spheroid& spheroid, double tolerance) {
    const TMatrix T =
        t_matrix(spheroid, std::max(SpheroidRule::kTShare * tolerance, SpheroidRule::kLeastT));
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
    Sums sums;
    sums.extinction = T.q_ext;
    sums.error = T.error_estimate;
    sums.series = math::matrix_series(orientation_average(T, cosines), rule, degree) /
                  std::pow(spheroid.size_parameter, 2);
    return sums;
}

class SpheroidAverage {
  public:
    SpheroidAverage(const EnsembleRequest& request, const Executor& run)
        : request_(request), run_(run), ensemble_(ensemble_of(request)) {}

    MatrixOptics compute() {
        if (ensemble_.law().single_size) {
            average({{effective_radius_of(ensemble_.sizes)}, {1.0}});
        } else {
            for (int sizes = SpheroidRule::kFirstSizes; sizes <= SpheroidRule::kMostSizes;
                 sizes *= 2) {
                average(smooth_size_nodes(ensemble_.sizes, ensemble_.range, sizes));
                if (result_.optics.converged) break;
            }
        }
        finish();
        return std::move(result_);
    }

  private:
    void average(const SizeNodes& nodes) {
        const int count = static_cast<int>(nodes.radius_um.size());
        std::vector<Sums> each(nodes.radius_um.size());
        run_(count, [&](int i) {
            const double x = ensemble_.wave_number_per_um * nodes.radius_um[std::size_t(i)];
            each[std::size_t(i)] =
                of_size({ensemble_.scatterer.relative_index, x, ensemble_.scatterer.aspect},
                        request_.tolerance);
        });
        Sums sums;
        for (std::size_t i = 0; i < each.size(); ++i)
            sums.add(each[i], nodes.area_share[i] / ensemble_.share);
        const MatrixOptics before = std::exchange(result_, {});
        const Eigen::MatrixXd series_before = std::move(series_);
        EnsembleOptics& o = result_.optics;
        o.q_ext = sums.extinction;
        o.q_sca = ensemble_.scatterer.absorbs() ? std::min(sums.scattering(), o.q_ext) : o.q_ext;
        o.q_abs = o.q_ext - o.q_sca;
        o.one_minus_albedo = o.q_abs / o.q_ext;
        o.single_scattering_albedo = o.q_sca / o.q_ext;
        o.asymmetry = sums.series(1, 0) / sums.scattering();
        o.size_nodes = before.optics.size_nodes + count;
        series_ = sums.series / sums.scattering();
        change_ = Eigen::VectorXd::Zero(std::max(series_.rows(), series_before.rows()));
        change_.head(series_.rows()) = series_.col(0);
        if (series_before.rows() > 0) change_.head(series_before.rows()) -= series_before.col(0);
        t_error_ = std::max(AverageLimits::kRounding, sums.error / sums.scattering());
        o.error_estimate = t_error_;
        if (!ensemble_.law().single_size) {
            double change = 1;
            if (before.optics.q_ext > 0)
                change = std::max({series_change(series_before, series_),
                                   std::abs(before.optics.q_ext / o.q_ext - 1),
                                   std::abs(before.optics.q_sca / o.q_sca - 1)});
            o.error_estimate += change + tail_for(request_);
        }
        o.converged = o.error_estimate <= request_.tolerance;
    }

    void finish() {
        put_series(series_, result_);
        EnsembleOptics& o = result_.optics;
        const std::vector<double> chi = o.chi;
        for (std::size_t i = 0; i < request_.angles_deg.size(); ++i) {
            const double x = cosine_of_scattering_angle(request_.angles_deg[i]);
            o.phase.push_back(math::legendre_series(chi, x));
            o.phase_error.push_back(phase_error(x));
            const double relative = o.phase_error[i] / o.phase[i];
            o.phase_error_estimate = std::max(o.phase_error_estimate, relative);
            o.converged = o.converged && (request_.phase_allowed.empty()
                                              ? relative <= request_.phase_tolerance
                                              : o.phase_error[i] <= request_.phase_allowed[i]);
        }
        o.phase_table = table(chi);
    }

    // The change of P by the last doubling of sizes, and errors of all degrees by the T-matrix, of
    // either sign: the root of the sum of (2l + 1)^2 P_l^2, P_l^2 about 1 / (2l + 1).
    double phase_error(double x) const {
        const std::span<const double> change(change_.data(), std::size_t(change_.size()));
        const double of_sizes =
            ensemble_.law().single_size ? 0.0 : std::abs(math::legendre_series(change, x));
        return of_sizes + t_error_ * static_cast<double>(series_.rows());
    }

    std::shared_ptr<const PhaseTable> table(const std::vector<double>& chi) const {
        const double degree = static_cast<double>(chi.size());
        const int panels = std::max(
            SpheroidRule::kFewestPanels,
            static_cast<int>(std::ceil(std::numbers::pi * degree / SpheroidRule::kPanelWaves)));
        PhaseTable::Parts parts;
        parts.noise_floor = 1.0;
        for (int i = 0; i <= panels; ++i) parts.edges.push_back(std::numbers::pi * i / panels);
        const Eigen::MatrixXd values = series_on_panels(chi, parts.edges);
        for (int panel = 0; panel < panels; ++panel) {
            const std::vector<double> nodes =
                panel_nodes(parts.edges[std::size_t(panel)], parts.edges[std::size_t(panel) + 1]);
            double error = 0;
            for (const double theta : nodes) error = std::max(error, phase_error(std::cos(theta)));
            const double brightest = values.col(panel).maxCoeff();
            parts.noise.push_back(error / std::max(brightest, parts.noise_floor));
            parts.size_error = std::max(parts.size_error, error / brightest);
            const Eigen::VectorXd coefficients = panel_coefficients(values.col(panel));
            parts.interpolation_error =
                std::max(parts.interpolation_error, coefficients.tail(2).cwiseAbs().maxCoeff() /
                                                        values.col(panel).cwiseAbs().maxCoeff());
        }
        return std::make_shared<const PhaseTable>(make_phase_table(std::move(parts), values));
    }

    const EnsembleRequest& request_;
    const Executor& run_;
    Ensemble ensemble_;
    Eigen::MatrixXd series_ = {};  // of the last sizes, whose first entry is 1
    Eigen::VectorXd change_ = {};  // of its moments, by the last doubling of sizes
    double t_error_ = 0;
    MatrixOptics result_;
};

}  // namespace

MatrixOptics average_spheroids(const EnsembleRequest& request, const Executor& run) {
    return SpheroidAverage(request, run).compute();
}

double spheroid_seconds(const EnsembleRequest& request) {
    const Ensemble ensemble = ensemble_of(request);
    const double sizes = ensemble.law().single_size ? 1 : SpheroidRule::kTypicalSizes;
    const double x = ensemble.scatterer.outer_x(ensemble.largest_x());
    return sizes * SpheroidRule::kSecondsPerDegree4 * std::pow(x + 4 * std::cbrt(x) + 4, 4);
}

}  // namespace miebrdf::mie
