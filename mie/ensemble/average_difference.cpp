// The difference of two averages over the same radii.
#include <miebrdf/ensemble.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include <miebrdf/error.h>
#include "mie/ensemble/exact_extinction.h"
#include "mie/ensemble/matrix_average.h"
#include "mie/ensemble/moment_transform.h"
#include "mie/ensemble/particle_ensemble.h"
#include "mie/ensemble/phase_table.h"
#include "mie/ensemble/ray_average.h"
#include "mie/ensemble/size_passes.h"
#include "mie/sizes/size_law.h"

namespace miebrdf::mie {
namespace {

using Rule = SizePasses::Rule;

struct DifferenceRule {
    /// Moments and phase functions settle later than efficiencies.
    static constexpr int kTimesAsManySizes = 2;
    /// Sizes at most; where there are angles, as many as take about a second.
    static constexpr int kMostSizes = 8192, kMostSmooth = 512;
    /// Averages over rays are smooth in every number, but of products in single precision: so many
    /// times the step, whose second order is then below 1e-5.
    static constexpr double kRaySteps = 100;
};

/// Radii, and the length of radius that each stands for.
struct Radii {
    Rule rule;
    std::vector<double> radius_um, length_um;
};

/// As many as efficiencies need.
Radii radii_of(const EnsembleRequest& request, double most, const Executor& run) {
    const Ensemble ensemble = ensemble_of(request);
    SizePasses passes(ensemble);
    if (passes.rule() == Rule::single) return {Rule::single, {ensemble.range.largest_um}, {1.0}};
    SizeSumOptions options;
    options.terms = ensemble.terms();
    double before = 0.0, error = 1.0;
    while (true) {
        const SizeSums& sums = passes.add(options, run);
        const double q_ext = 2 * (sums.spheres.scattered + sums.spheres.absorbed) / ensemble.share;
        const double change = before > 0.0 ? std::abs(q_ext / before - 1) : 1.0;
        const double exact = passes.exact_q_ext();
        const double missed = exact > 0 ? std::abs(q_ext / exact - 1) : change;
        error = passes.is_first() ? 1.0 : passes.error(change, missed, 0.25, 0.0, 1e-13);
        before = q_ext;
        if (error <= request.tolerance || passes.sizes_so_far() >= most || !passes.refine()) break;
    }
    const bool is_smooth = passes.rule() == Rule::smooth;
    const int wanted = DifferenceRule::kTimesAsManySizes * passes.sizes_so_far();
    const int count = std::max(16, int(std::min({double(wanted), most,
                                                 double(is_smooth ? DifferenceRule::kMostSmooth
                                                                  : DifferenceRule::kMostSizes)})));
    const SizeNodes nodes = is_smooth ? smooth_size_nodes(request.sizes, ensemble.range, count)
                                      : even_size_nodes(request.sizes, ensemble.range, count, 0.5);
    const auto density = area_density(request.sizes);
    Radii radii{passes.rule(), nodes.radius_um, {}};
    for (std::size_t i = 0; i < nodes.radius_um.size(); ++i)
        radii.length_um.push_back(nodes.area_share[i] / density->at(nodes.radius_um[i]));
    return radii;
}

/// The sums of one of the two requests.
class OneSide {
  public:
    OneSide(const EnsembleRequest& request, const Ensemble& middle, const Radii& radii,
            const SizeSumOptions& options, const Executor& run)
        : ensemble_(ensemble_of(request)), share_(middle.share) {
        SizeNodes nodes{radii.radius_um, {}};
        if (radii.rule == Rule::single) {
            nodes = {{ensemble_.range.largest_um}, {1.0}};
        } else {
            const auto density = area_density(request.sizes);
            for (std::size_t i = 0; i < radii.radius_um.size(); ++i)
                nodes.area_share.push_back(radii.length_um[i] * density->at(radii.radius_um[i]));
        }
        sums_ = sums_at(nodes, options, run);
        if (radii.rule != Rule::single && ensemble_.law().has_ends) {
            add_end(middle.range.largest_um, ensemble_.range.largest_um - middle.range.largest_um,
                    options, run);
            add_end(middle.range.smallest_um,
                    middle.range.smallest_um - ensemble_.range.smallest_um, options, run);
        }
        q_sca_ = 2 * sums_.spheres.scattered / share_;
        q_abs_ = 2 * sums_.spheres.absorbed / share_;
        q_ext_ = q_sca_ + q_abs_;
        if (radii.rule != Rule::even || !ensemble_.law().analytic ||
            !ensemble_.scatterer.is_plain())
            return;
        q_ext_ = exact_extinction(ensemble_, run) / ensemble_.share;
        q_sca_ = q_ext_ - q_abs_;
    }

    const SizeSums& sums() const { return sums_; }
    double q_ext() const { return q_ext_; }
    double one_minus_albedo() const { return q_abs_ / q_ext_; }
    double albedo() const { return q_sca_ / q_ext_; }
    double asymmetry() const { return 2 * sums_.spheres.asymmetric / sums_.spheres.scattered; }
    /// P at the angles of the sums.
    Eigen::VectorXd phase() const { return sums_.intensity / (2 * sums_.spheres.scattered); }

  private:
    SizeSums sums_at(const SizeNodes& nodes, const SizeSumOptions& options,
                     const Executor& run) const {
        return sum_over_sizes(ensemble_.scatterer,
                              WeightedSizes(nodes, ensemble_.wave_number_per_um), options, run);
    }

    /// Adds the spheres that the law gains (or loses) where it ends a little farther out.
    void add_end(double radius_um, double gained_um, const SizeSumOptions& options,
                 const Executor& run) {
        if (gained_um == 0.0) return;
        const double share = std::abs(gained_um) * area_density(ensemble_.sizes)->at(radius_um);
        SizeSums end = sums_at({{radius_um}, {share}}, options, run);
        if (gained_um < 0.0) end.scale(-1.0);
        sums_.add(end);
    }

    Ensemble ensemble_;
    double share_;
    SizeSums sums_;
    double q_sca_ = 0, q_abs_ = 0, q_ext_ = 0;
};

std::vector<double> difference(std::vector<double> a, const std::vector<double>& b) {
    for (std::size_t k = 0; k < a.size(); ++k) a[k] -= b[k];
    return a;
}

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

/// Two numbers of a request in the middle, farther apart.
EnsembleRequest farther(const EnsembleRequest& middle, const EnsembleRequest& side) {
    EnsembleRequest result = side;
    const auto move = [](auto& number, const auto& from) {
        number = from + DifferenceRule::kRaySteps * (number - from);
    };
    move(result.sizes.effective_radius_um, middle.sizes.effective_radius_um);
    move(result.sizes.effective_variance, middle.sizes.effective_variance);
    move(result.refractive_index, middle.refractive_index);
    move(result.host_index, middle.host_index);
    return result;
}

/// Where averages are over rays, as those of large spheres of many sizes: no sphere is needed.
/// Nothing where they are not, or where only one side is possible and so large a step errs.
std::optional<EnsembleDifference> difference_of_rays(const EnsembleRequest& middle,
                                                     const EnsembleRequest& plus,
                                                     const EnsembleRequest& minus,
                                                     const DifferenceDemand& demand,
                                                     const Executor& run) {
    const auto numbers = [](const EnsembleRequest& one) {
        return std::array{one.sizes.effective_radius_um, one.sizes.effective_variance,
                          one.refractive_index.real(), one.refractive_index.imag(), one.host_index};
    };
    if (demand.matrix_degree >= 0 || demand.phase_table != nullptr ||
        demand.highest_moment > AverageLimits::kMostBandWidth || numbers(plus) == numbers(middle) ||
        numbers(minus) == numbers(middle))
        return std::nullopt;
    const auto average = [&](const EnsembleRequest& request) {
        return average_over_rays(ensemble_of(request), std::max(1, demand.highest_moment),
                                 middle.tolerance, run);
    };
    const auto a = average(farther(middle, plus)), b = average(farther(middle, minus));
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
    for (int l = 0; l <= demand.highest_moment; ++l)
        result.chi.push_back(slope(a->chi[std::size_t(l)], b->chi[std::size_t(l)]));
    return result;
}

}  // namespace

EnsembleDifference difference_of_averages(const EnsembleRequest& middle,
                                          const EnsembleRequest& plus, const EnsembleRequest& minus,
                                          const DifferenceDemand& demand, const Executor& run) {
    for (const EnsembleRequest* request : {&middle, &plus, &minus}) {
        validate(*request);
        if (request->aspect) throw UsageError("derivatives by sizes and indices are of spheres");
    }
    const Executor pieces = flushing(run);
    if (auto rays = difference_of_rays(middle, plus, minus, demand, pieces)) return *rays;
    const Ensemble ensemble = ensemble_of(middle);
    SizeSumOptions options;
    options.terms =
        std::max({ensemble.terms(), ensemble_of(plus).terms(), ensemble_of(minus).terms()});

    std::optional<AngularFunctions> angles;
    math::Quadrature rule;
    if (demand.matrix_degree >= 0) {
        rule = math::gauss_legendre(matrix_nodes(options.terms, demand.matrix_degree));
        angles.emplace(
            Eigen::Map<const Eigen::ArrayXd>(rule.nodes.data(), Eigen::Index(rule.nodes.size())),
            options.terms, pieces);
        options.with_matrix = true;
    } else if (demand.phase_table != nullptr) {
        angles.emplace(angles_of(*demand.phase_table), options.terms, pieces);
    }
    if (angles) options.angles = &*angles;
    // Beyond the band moments are those of the panels.
    const bool from_table =
        demand.phase_table != nullptr && demand.highest_moment > AverageLimits::kMostBandWidth;
    if (demand.highest_moment >= 2 && demand.matrix_degree < 0)
        options.band_width = from_table ? AverageLimits::kSafeBandWidth : demand.highest_moment;

    const double per_size = 4.0 * options.terms * (angles ? angles->angle_count() : 0);
    const double most =
        per_size > 0 ? AverageLimits::kProductsPerSecond / per_size : DifferenceRule::kMostSizes;
    const Radii radii = radii_of(middle, most, pieces);
    const OneSide a(plus, ensemble, radii, options, pieces),
        b(minus, ensemble, radii, options, pieces);

    EnsembleDifference result;
    result.single_scattering_albedo = a.albedo() - b.albedo();
    result.one_minus_albedo = a.one_minus_albedo() - b.one_minus_albedo();
    result.q_ext = a.q_ext() - b.q_ext();
    result.asymmetry = a.asymmetry() - b.asymmetry();
    if (demand.matrix_degree >= 0) {
        const auto series = [&](const OneSide& side) -> Eigen::MatrixXd {
            const Eigen::MatrixXd rows = matrix_series_of(
                side.sums().products, side.sums().spheres.scattered, rule, demand.matrix_degree);
            return rows / rows(0, 0);
        };
        const Eigen::MatrixXd change = series(a) - series(b);
        const auto list = [&](int column, bool with_factor) {
            std::vector<double> values;
            for (Eigen::Index l = 0; l < change.rows(); ++l)
                values.push_back((with_factor ? 2.0 * double(l) + 1.0 : 1.0) * change(l, column));
            return values;
        };
        result.chi = list(0, false);
        result.expansion = {list(2, true), list(3, true), list(1, true), list(4, true),
                            list(5, true)};
        return result;
    }
    if (demand.phase_table != nullptr)
        result.phase_table = table_of(a.phase() - b.phase(), *demand.phase_table);
    if (demand.highest_moment >= 0) result.chi.push_back(0.0);
    if (demand.highest_moment == 1) result.chi.push_back(result.asymmetry);
    if (options.band_width < 0) return result;
    const MomentTransform transform(options.terms, options.band_width);
    const auto moments = [&](const OneSide& side) {
        std::vector<double> chi = transform(side.sums().covariance, pieces);
        const double whole = chi[0];
        for (double& one : chi) one /= whole;
        return chi;
    };
    result.chi = difference(moments(a), moments(b));
    if (from_table) {
        const std::vector<double> all = result.phase_table->moments(demand.highest_moment, pieces);
        result.chi.insert(result.chi.end(), all.begin() + Eigen::Index(result.chi.size()),
                          all.end());
    }
    return result;
}

}  // namespace miebrdf::mie
