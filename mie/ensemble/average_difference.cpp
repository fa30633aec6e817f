// Differences of averages over the same radii.
#include <miebrdf/ensemble.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include <miebrdf/error.h>
#include "mie/ensemble/changed_sums.h"
#include "mie/ensemble/fixed_radii.h"
#include "mie/ensemble/matrix_average.h"
#include "mie/ensemble/moment_transform.h"
#include "mie/ensemble/paired_size_samples.h"
#include "mie/ensemble/particle_ensemble.h"
#include "mie/ensemble/phase_table.h"
#include "mie/ensemble/ray_average.h"
#include "rte/math/quadrature.h"

namespace miebrdf::mie {
namespace {

struct DifferenceRule {
    /// For the products at angles.
    static constexpr double kSeconds = 0.5;
    /// Averages over rays are smooth in every number, but of products in single precision: so many
    /// times the step, whose second order is then below 1e-5.
    static constexpr double kRaySteps = 100;
    /// P by rays turns its interference with every step, so that what a level of sizes leaves of
    /// that is to be small beside the change: a hundredth of the number.
    static constexpr double kRayPhaseSteps = 1000;
    static constexpr int kRayLevel = 1;
};

/// All panel nodes, panel by panel, in degrees.
std::vector<double> angles_of(const PhaseTable& table) {
    std::vector<double> angles_deg;
    const std::vector<double>& edges = table.parts().edges;
    for (std::size_t p = 0; p + 1 < edges.size(); ++p) {
        for (const double theta : panel_nodes(edges[p], edges[p + 1]))
            angles_deg.push_back(std::clamp(theta * 180 / std::numbers::pi, 0.0, 180.0));
    }
    return angles_deg;
}

std::shared_ptr<const PhaseTable> table_of(const Eigen::VectorXd& values, const PhaseTable& like) {
    PhaseTable::Parts parts;
    parts.edges = like.parts().edges;
    for (Eigen::Index at = 0; at < values.size(); at += PhaseTable::kPanelNodes) {
        const Eigen::VectorXd own = panel_coefficients(values.segment(at, PhaseTable::kPanelNodes));
        parts.coefficients.insert(parts.coefficients.end(), own.begin(), own.end());
    }
    return std::make_shared<const PhaseTable>(PhaseTable(std::move(parts)));
}

/// Those beyond the ones that are there.
void add_moments_of_table(int highest, const Executor& run, EnsembleDifference& to) {
    const std::vector<double> all = to.phase_table->moments(highest, run);
    to.chi.insert(to.chi.end(), all.begin() + Eigen::Index(to.chi.size()), all.end());
}

/// Two numbers of a request in the middle, farther apart.
EnsembleRequest farther(const EnsembleRequest& middle, const EnsembleRequest& side,
                        double times = DifferenceRule::kRaySteps) {
    EnsembleRequest result = side;
    const auto move = [times](auto& number, const auto& from) {
        number = from + times * (number - from);
    };
    move(result.sizes.effective_radius_um, middle.sizes.effective_radius_um);
    move(result.sizes.effective_variance, middle.sizes.effective_variance);
    move(result.refractive_index, middle.refractive_index);
    move(result.host_index, middle.host_index);
    return result;
}

/// Whether both sides of a change differ from the middle: with one alone so large a step errs.
bool has_room(const EnsembleRequest& middle, const EnsembleChange& change) {
    const auto numbers = [](const EnsembleRequest& one) {
        return std::array{one.sizes.effective_radius_um, one.sizes.effective_variance,
                          one.refractive_index.real(), one.refractive_index.imag(), one.host_index};
    };
    return numbers(change.plus) != numbers(middle) && numbers(change.minus) != numbers(middle);
}

/// By which rays P may be had at both sides of a change of spheres, as tables choose them; nothing
/// where not, and where other laws weigh the same spheres.
std::optional<PhaseMethod> rays_of_phase(const EnsembleRequest& middle,
                                         const EnsembleChange& far_apart) {
    if (far_apart.plus.refractive_index == far_apart.minus.refractive_index &&
        far_apart.plus.host_index == far_apart.minus.host_index)
        return std::nullopt;
    for (const PhaseMethod method : {PhaseMethod::rays, PhaseMethod::exact_rays}) {
        const auto is_good = [&](const EnsembleRequest& side) {
            const PhaseRayBias bias =
                phase_ray_bias(ensemble_of(side), method == PhaseMethod::exact_rays);
            return bias.everywhere > 0 &&
                   bias.typical() <= AverageLimits::kPartShare * middle.phase_tolerance;
        };
        if (is_good(far_apart.plus) && is_good(far_apart.minus)) return method;
    }
    return std::nullopt;
}

Eigen::VectorXd phase_by_rays(const EnsembleRequest& request, PhaseMethod method,
                              const std::vector<double>& angles_deg, const Executor& run) {
    const Ensemble ensemble = ensemble_of(request);
    PairedSizeSamples sizes(ensemble, method);
    const std::vector<int> levels(std::size_t(sizes.part_count()), DifferenceRule::kRayLevel);
    Eigen::VectorXd intensity = Eigen::VectorXd::Zero(Eigen::Index(angles_deg.size()));
    double scattered = 0;
    for (const PairedIntensity& part : sizes.levels(levels, angles_deg, false, run)) {
        intensity += part.intensity.rowwise().sum();
        scattered += part.scattered[0] + part.scattered[1];
    }
    return intensity / scattered;
}

/// Where averages are over rays, as those of large spheres of many sizes: no sphere is needed.
/// Nothing where they are not.
std::optional<EnsembleDifference> difference_of_rays(const EnsembleRequest& middle,
                                                     const EnsembleChange& change,
                                                     const DifferenceDemand& demand,
                                                     const Executor& run) {
    const bool has_table = demand.phase_table != nullptr;
    const bool from_table = has_table && demand.highest_moment > AverageLimits::kMostBandWidth;
    if (demand.matrix_degree >= 0 || !has_room(middle, change) ||
        (demand.highest_moment > AverageLimits::kMostBandWidth && !has_table))
        return std::nullopt;
    const double times = DifferenceRule::kRayPhaseSteps;
    const EnsembleChange far_apart{farther(middle, change.plus, times),
                                   farther(middle, change.minus, times)};
    std::optional<PhaseMethod> method;
    if (has_table && !(method = rays_of_phase(middle, far_apart))) return std::nullopt;
    const int highest = from_table ? AverageLimits::kSafeBandWidth : demand.highest_moment;
    const auto average = [&](const EnsembleRequest& request) {
        return average_over_rays(ensemble_of(request), std::max(1, highest), middle.tolerance, run);
    };
    const auto a = average(farther(middle, change.plus)),
               b = average(farther(middle, change.minus));
    if (!a || !b || a->size_nodes != b->size_nodes) return std::nullopt;
    const auto slope = [](double above, double below) {
        return (above - below) / DifferenceRule::kRaySteps;
    };
    EnsembleDifference result;
    result.single_scattering_albedo =
        slope(a->single_scattering_albedo, b->single_scattering_albedo);
    result.one_minus_albedo = slope(a->one_minus_albedo, b->one_minus_albedo);
    result.q_ext = slope(a->q_ext, b->q_ext);
    result.asymmetry = slope(a->asymmetry, b->asymmetry);
    for (int l = 0; l <= highest; ++l)
        result.chi.push_back(slope(a->chi[std::size_t(l)], b->chi[std::size_t(l)]));
    if (!method) return result;
    const std::vector<double> angles_deg = angles_of(*demand.phase_table);
    result.phase_table = table_of((phase_by_rays(far_apart.plus, *method, angles_deg, run) -
                                   phase_by_rays(far_apart.minus, *method, angles_deg, run)) /
                                      times,
                                  *demand.phase_table);
    if (from_table) add_moments_of_table(demand.highest_moment, run, result);
    return result;
}

/// What is asked of all changes, at fixed radii.
class DifferenceSums {
  public:
    DifferenceSums(const EnsembleRequest& middle, const DifferenceDemand& demand, int terms,
                   const Executor& run)
        : middle_(middle), demand_(demand), run_(run) {
        options_.terms = terms;
        options_.with_matrix = demand.matrix_degree >= 0;
        if (options_.with_matrix) {
            rule_ = math::gauss_legendre(matrix_nodes(terms, demand.matrix_degree));
        } else if (demand.phase_table != nullptr) {
            angles_deg_ = angles_of(*demand.phase_table);
        }
        // Beyond the band moments are those of the panels.
        from_table_ =
            demand.phase_table != nullptr && demand.highest_moment > AverageLimits::kMostBandWidth;
        if (demand.highest_moment >= 2 && !options_.with_matrix)
            options_.band_width =
                from_table_ ? AverageLimits::kSafeBandWidth : demand.highest_moment;
        const double angles = double(std::max(rule_.nodes.size(), angles_deg_.size()));
        most_sizes_ = angles > 0 ? DifferenceRule::kSeconds * AverageLimits::kProductsPerSecond /
                                       (4.0 * terms * angles)
                                 : RadiiRule::kMostSizes;
    }

    std::vector<EnsembleDifference> of(const std::vector<EnsembleChange>& changes) {
        const Radii radii = radii_of(middle_, most_sizes_, run_);
        const FixedRadii fixed(middle_, radii);
        std::vector<SpheresChange> spheres;
        spheres.reserve(changes.size());
        for (const EnsembleChange& change : changes) spheres.push_back(fixed.change(change));
        const bool in_single = radii.is_even && !options_.with_matrix &&
                               middle_.tolerance >= AverageLimits::kLeastSingleTolerance;
        sums_ = in_single ? sums<float>(fixed, spheres) : sums<double>(fixed, spheres);
        if (options_.band_width >= 0) transform_.emplace(options_.terms, options_.band_width);
        const double factor = 2 / fixed.ensemble().share;
        q_abs_ = factor * sums_.middle.spheres.absorbed;
        q_ext_ = q_abs_ + factor * sums_.middle.spheres.scattered;
        std::vector<EnsembleDifference> all;
        all.reserve(changes.size());
        for (const SizeSums& more : sums_.differences)
            all.push_back(difference(more, factor * more.spheres.absorbed,
                                     factor * (more.spheres.scattered + more.spheres.absorbed)));
        return all;
    }

  private:
    template <typename Scalar>
    ChangedSums sums(const FixedRadii& fixed, const std::vector<SpheresChange>& changes) const {
        std::optional<AngularFunctionsOf<Scalar>> angles;
        if (options_.with_matrix) {
            angles.emplace(Eigen::Map<const Eigen::ArrayXd>(rule_.nodes.data(),
                                                            Eigen::Index(rule_.nodes.size())),
                           options_.terms, run_);
        } else if (!angles_deg_.empty()) {
            angles.emplace(angles_deg_, options_.terms, run_);
        }
        return sums_with_changes<Scalar>(fixed.radius_um(), fixed.spheres(middle_), changes,
                                         options_, angles ? &*angles : nullptr, run_);
    }

    EnsembleDifference difference(const SizeSums& more, double q_abs, double q_ext) const {
        const SphereSums& whole = sums_.middle.spheres;
        const double gain = more.spheres.scattered / whole.scattered;
        EnsembleDifference result;
        result.one_minus_albedo = (q_abs - q_abs_ / q_ext_ * q_ext) / q_ext_;
        result.single_scattering_albedo = -result.one_minus_albedo;
        result.q_ext = q_ext;
        result.asymmetry =
            2 * (more.spheres.asymmetric - gain * whole.asymmetric) / whole.scattered;
        if (options_.with_matrix) {
            put_matrix(more, result);
            return result;
        }
        if (demand_.phase_table != nullptr) {
            const auto intensity = [](const SizeSums& sums) {
                return (sums.products.col(0) + sums.products.col(1)).matrix().eval();
            };
            result.phase_table =
                table_of((intensity(more) - gain * intensity(sums_.middle)) / (2 * whole.scattered),
                         *demand_.phase_table);
        }
        if (demand_.highest_moment >= 0) result.chi.push_back(0.0);
        if (demand_.highest_moment == 1) result.chi.push_back(result.asymmetry);
        if (!transform_) return result;
        const std::vector<double> all = (*transform_)(sums_.middle.covariance, run_);
        result.chi = (*transform_)(more.covariance, run_);
        const double of_whole = result.chi[0] / all[0];
        for (std::size_t l = 0; l < all.size(); ++l)
            result.chi[l] = (result.chi[l] - of_whole * all[l]) / all[0];
        if (from_table_) add_moments_of_table(demand_.highest_moment, run_, result);
        return result;
    }

    void put_matrix(const SizeSums& more, EnsembleDifference& result) const {
        const double scattered = sums_.middle.spheres.scattered;
        const auto series = [&](const SizeSums& sums) {
            return matrix_series_of(sums.products, scattered, rule_, demand_.matrix_degree);
        };
        const Eigen::MatrixXd middle = series(sums_.middle);
        Eigen::MatrixXd change = series(more);
        change = ((change - change(0, 0) / middle(0, 0) * middle) / middle(0, 0)).eval();
        const auto list = [&](int column, bool with_factor) {
            std::vector<double> values;
            for (Eigen::Index l = 0; l < change.rows(); ++l)
                values.push_back((with_factor ? 2.0 * double(l) + 1.0 : 1.0) * change(l, column));
            return values;
        };
        result.chi = list(0, false);
        result.expansion = {list(2, true), list(3, true), list(1, true), list(4, true),
                            list(5, true)};
    }

    const EnsembleRequest& middle_;
    const DifferenceDemand& demand_;
    const Executor& run_;
    SizeSumOptions options_ = {};
    math::Quadrature rule_ = {};
    std::vector<double> angles_deg_ = {};
    bool from_table_ = false;
    double most_sizes_ = 0;
    ChangedSums sums_ = {};
    std::optional<MomentTransform> transform_ = {};
    double q_abs_ = 0, q_ext_ = 0;
};

}  // namespace

std::vector<EnsembleDifference> differences_of_averages(const EnsembleRequest& middle,
                                                        const std::vector<EnsembleChange>& changes,
                                                        const DifferenceDemand& demand,
                                                        const Executor& run) {
    const auto require = [](const EnsembleRequest& request) {
        validate(request);
        if (request.aspect) throw UsageError("derivatives by sizes and indices are of spheres");
    };
    require(middle);
    const Executor pieces = flushing(run);
    // Sizes around a sharp end are a little larger.
    const auto terms_of_largest = [](const EnsembleRequest& request) {
        const Ensemble own = ensemble_of(request);
        const double beyond = own.law().has_ends ? RadiiRule::kWidest : 0.0;
        return own.scatterer.terms((1 + beyond) * own.largest_x());
    };
    int terms = terms_of_largest(middle);
    std::vector<EnsembleDifference> all(changes.size());
    std::vector<EnsembleChange> by_spheres;
    std::vector<std::size_t> places;
    for (std::size_t c = 0; c < changes.size(); ++c) {
        for (const EnsembleRequest* side : {&changes[c].plus, &changes[c].minus}) {
            require(*side);
            terms = std::max(terms, terms_of_largest(*side));
        }
        if (auto rays = difference_of_rays(middle, changes[c], demand, pieces)) {
            all[c] = std::move(*rays);
        } else {
            by_spheres.push_back(changes[c]);
            places.push_back(c);
        }
    }
    if (by_spheres.empty()) return all;
    std::vector<EnsembleDifference> others =
        DifferenceSums(middle, demand, terms, pieces).of(by_spheres);
    for (std::size_t i = 0; i < places.size(); ++i) all[places[i]] = std::move(others[i]);
    return all;
}

}  // namespace miebrdf::mie
