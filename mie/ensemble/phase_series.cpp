#include "mie/ensemble/phase_series.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <span>

#include "mie/ensemble/phase_table.h"
#include "mie/ensemble/size_refinement.h"
#include "rte/math/legendre.h"

namespace miebrdf::mie {
namespace {

using Array = Eigen::ArrayXd;

// Efficiencies, all moments, and P at the nodes.
class SeriesSummation : public SizeSummation {
  public:
    /// @param tolerance  the least that P and moments are asked for, relative
    SeriesSummation(const Ensemble& ensemble, double tolerance, const Executor& run)
        : ensemble_(ensemble),
          run_(run),
          terms_(ensemble.terms()),
          gauss_(terms_, 2 * terms_, may_be_single(ensemble, tolerance), run),
          theta_(gauss_.cosines().acos()) {}

    SizeSums sum(const SizeNodes& nodes, bool all) const override {
        SizeSumOptions options;
        options.terms = terms_;
        if (all) options.angles = &gauss_.angles();
        return sum_over_sizes(ensemble_.scatterer,
                              WeightedSizes(nodes, ensemble_.wave_number_per_um), options, run_);
    }

    Array averages(const SizeSums& sums) const override {
        const std::vector<double> chi = gauss_.of(sums.intensity);
        Array all(moment_count() + nodes());
        all << Eigen::Map<const Array>(chi.data(), moment_count()) / chi[0],
            sums.intensity.array() / (2 * sums.spheres.scattered);
        return all;
    }

    double size_of(const Array& change, const Array& averages,
                   const SphereSums& sums) const override {
        return std::max(change.head(moment_count()).abs().maxCoeff(),
                        tolerance(sums) / SizeRule::kSafety *
                            noise_over_allowed(change.tail(nodes()), averages, sums));
    }

    /// All that are not rounding.
    std::vector<double> chi(const RefinedAverage& average) const {
        Eigen::Index count = moment_count();
        while (count > 2 &&
               std::abs(average.averages[count - 1]) <= 4 * std::numeric_limits<double>::epsilon())
            --count;
        return {average.averages.begin(), average.averages.begin() + count};
    }
    Array phase(const RefinedAverage& average) const { return average.averages.tail(nodes()); }
    /// 0 at each node where there is no last change.
    Array change_of_phase(const RefinedAverage& average) const {
        if (average.change.size() == 0) return Array::Zero(nodes());
        return average.change.tail(nodes());
    }
    const Array& angles() const { return theta_; }
    int most_sizes(double work) const {
        const double each = double(terms_) * double(nodes());
        return int(std::min(double(SizeRule::kMostEven), work / each));
    }

  protected:
    /// Where it is largest.
    /// @param change  of P at the nodes
    virtual double noise_over_allowed(const Array& change, const Array& averages,
                                      const SphereSums& sums) const = 0;
    Eigen::Index moment_count() const { return 2 * terms_ + 1; }
    Eigen::Index nodes() const { return theta_.size(); }
    double noise_at(double theta, const Array& change) const {
        return noise_around(theta, theta, change, theta_, std::numbers::pi / double(nodes()));
    }
    const Ensemble& ensemble() const { return ensemble_; }

  private:
    const Ensemble& ensemble_;
    const Executor& run_;
    int terms_;
    GaussMoments gauss_;
    Array theta_;
};

class TableSummation : public SeriesSummation {
  public:
    TableSummation(const EnsembleRequest& request, const Ensemble& ensemble, const Executor& run)
        : SeriesSummation(ensemble, least_tolerance(request, ensemble, run), run),
          request_(request) {}

    double tolerance(const SphereSums& sums) const override {
        return wanted_error(request_, efficiencies_of(sums, ensemble().share));
    }

    /// P below this errs relative to it.
    double floor(const SphereSums& sums) const { return bright(sums) * request_.phase_floor; }

  protected:
    // By the rms around each node, as the table states it.
    double noise_over_allowed(const Array& change, const Array& averages,
                              const SphereSums& sums) const override {
        const Array relative = change / averages.tail(nodes()).max(floor(sums));
        double largest = 0;
        for (const double theta : angles()) largest = std::max(largest, noise_at(theta, relative));
        return largest / (share_of_tolerance(bright(sums)) * request_.phase_tolerance);
    }

  private:
    /// By the efficiencies of a few sizes, where absorption makes the medium dark.
    static double least_tolerance(const EnsembleRequest& request, const Ensemble& ensemble,
                                  const Executor& run) {
        const double asked = std::min(request.tolerance, request.phase_tolerance);
        if (ensemble.law().single_size || !(ensemble.scatterer.damping(ensemble.effective_x()) > 0))
            return asked;
        const SizeNodes few =
            smooth_size_nodes(ensemble.sizes, ensemble.range, SizeRule::kFirstGauss);
        const SphereSums sums =
            sum_over_sizes(ensemble.scatterer, WeightedSizes(few, ensemble.wave_number_per_um), {},
                           run)
                .spheres;
        return std::min(
            wanted_error(request, efficiencies_of(sums, ensemble.share)),
            share_of_tolerance(bright(request, ensemble, sums)) * request.phase_tolerance);
    }
    static double share_of_tolerance(double bright) {
        return std::max(bright, DarkMedium::kLeastShare);
    }
    static double bright(const EnsembleRequest& request, const Ensemble& ensemble,
                         const SphereSums& sums) {
        if (!(request.phase_floor > 0)) return 1;
        return half_space_albedo(efficiencies_of(sums, ensemble.share));
    }
    double bright(const SphereSums& sums) const { return bright(request_, ensemble(), sums); }

    const EnsembleRequest& request_;
};

class PointSummation : public SeriesSummation {
  public:
    PointSummation(const EnsembleRequest& request, const Ensemble& ensemble, const Executor& run)
        : SeriesSummation(ensemble, request.phase_tolerance, run), request_(request) {}

    double tolerance(const SphereSums&) const override { return 1; }

    double error_at(double angle_deg, const Array& change) const {
        return AverageLimits::kDeviations * noise_at(angle_deg * std::numbers::pi / 180, change);
    }

  protected:
    double noise_over_allowed(const Array& change, const Array& averages,
                              const SphereSums&) const override {
        const std::span<const double> chi(averages.data(), std::size_t(moment_count()));
        double largest = 0;
        for (std::size_t i = 0; i < request_.angles_deg.size(); ++i) {
            const double angle = request_.angles_deg[i];
            const double allowed = request_.phase_allowed.empty()
                                       ? request_.phase_tolerance * least_counted(chi, angle)
                                       : request_.phase_allowed[i];
            largest = std::max(largest, error_at(angle, change) / allowed);
        }
        return largest;
    }

  private:
    /// P at the angle, as the errors are judged by that are stated.
    double least_counted(std::span<const double> chi, double angle_deg) const {
        const double phase = math::legendre_series(chi, cosine_of_scattering_angle(angle_deg));
        // P is positive; rounding is not.
        return std::max({phase, request_.phase_floor, std::numeric_limits<double>::min()});
    }

    const EnsembleRequest& request_;
};

}  // namespace

GaussMoments::GaussMoments(int terms, int highest_moment, bool single_precision,
                           const Executor& run)
    : highest_(highest_moment),
      rule_(math::gauss_legendre(terms + highest_moment / 2 + 1)),
      angles_(angular_tables(cosines(), terms, single_precision, run)) {}

std::vector<double> GaussMoments::of(const Eigen::VectorXd& intensity) const {
    const Eigen::Index count = intensity.size();
    const auto x = cosines();
    const Eigen::Map<const Array> weights(rule_.weights.data(), count);
    const Array values = weights * intensity.array();
    Array before = Array::Zero(count), here = Array::Ones(count);
    std::vector<double> moments;
    for (int l = 0; l <= highest_; ++l) {
        moments.push_back((values * here).sum());
        before = ((2.0 * l + 1) / (l + 1.0)) * x * here - (l / (l + 1.0)) * before;
        before.swap(here);
    }
    return moments;
}

// Sums at all nodes take less time than the waves up to as many moments as a band may have.
bool has_phase_series(const Ensemble& ensemble) {
    return 2 * ensemble.terms() <= AverageLimits::kMostBandWidth;
}

EnsembleOptics average_phase_series(const EnsembleRequest& request, const Ensemble& ensemble,
                                    const Executor& run) {
    const TableSummation summation(request, ensemble, run);
    const RefinedAverage average = refine_sizes(ensemble, summation, request.tolerance);
    EnsembleOptics optics = efficiencies_of(average.sums.spheres, ensemble.share);
    optics.size_nodes = average.sizes;
    optics.error_estimate = average.error_estimate;
    optics.converged = optics.error_estimate <= request.tolerance;
    optics.chi = summation.chi(average);
    // The sums of g go on when those of P have ended.
    optics.chi[1] = optics.asymmetry;
    const double floor = summation.floor(average.sums.spheres);
    const Array noise = summation.change_of_phase(average) / summation.phase(average).max(floor);
    optics.phase_table = std::make_shared<const PhaseTable>(
        table_of_series(optics.chi, noise, summation.angles(), floor, request.tolerance));
    optics.chi.resize(std::size_t(std::max(0, request.highest_moment + 1)), 0.0);
    return optics;
}

PhaseValues phase_series_at_angles(const EnsembleRequest& request, const Ensemble& ensemble,
                                   const Executor& run) {
    const PointSummation summation(request, ensemble, run);
    const RefinedAverage average =
        refine_sizes(ensemble, summation, 1.0, summation.most_sizes(request.phase_work));
    const std::vector<double> chi = summation.chi(average);
    const Array change = summation.change_of_phase(average);
    PhaseValues values;
    for (const double angle : request.angles_deg) {
        values.phase.push_back(math::legendre_series(chi, cosine_of_scattering_angle(angle)));
        values.error.push_back(summation.error_at(angle, change));
    }
    return values;
}

}  // namespace miebrdf::mie
