#include "mie/ensemble/fixed_radii.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "mie/sizes/size_law.h"
#include "mie/sizes/size_nodes.h"

namespace miebrdf::mie {
namespace {

using Rule = SizePasses::Rule;

/// Radii around a sharp end of a law, by which what it gains there is told: the end alone where
/// spheres are smooth in size; else as many as see all phases of ripple and interference, with
/// weights that have no edges and no second moment: what is smooth there is the value at the end.
SizeNodes nodes_at_end(const Ensemble& ensemble, double end_um, Rule rule) {
    if (rule != Rule::even) return {{end_um}, {1.0}};
    const double period = ensemble.scatterer.ripple_period(),
                 x = ensemble.wave_number_per_um * end_um;
    const double interference =
        std::numbers::pi / std::max(std::abs(ensemble.scatterer.n() - 1), 1e-3);
    const double half =
        std::min(std::max(interference, RadiiRule::kPeriods * period), RadiiRule::kWidest * x);
    const int count = std::max(5, int(2 * half * RadiiRule::kSizesPerPeriod / period));
    const Eigen::ArrayXd s = Eigen::ArrayXd::LinSpaced(count, -1.0, 1.0) * (1.0 - 1.0 / count);
    Eigen::ArrayXd share = (1.0 + (std::numbers::pi * s).cos()) / count;
    const double second = (share * s.square()).sum(), fourth = (share * s.pow(4)).sum();
    share *= (fourth - second * s.square()) / (fourth - second * second);
    const Eigen::ArrayXd radius_um = end_um * (1.0 + half / x * s);
    return {{radius_um.begin(), radius_um.end()}, {share.begin(), share.end()}};
}

}  // namespace

Radii radii_of(const EnsembleRequest& request, double most, const Executor& run) {
    const Ensemble ensemble = ensemble_of(request);
    SizePasses passes(ensemble);
    if (passes.rule() == Rule::single)
        return {Rule::single, {ensemble.range.largest_um}, {1.0}, 0.0};
    SizeSumOptions options;
    options.terms = ensemble.terms();
    double before = 0.0, absorbed = 0.0, absorption_error = 1.0, error = 1.0;
    while (true) {
        const SizeSums& sums = passes.add(options, run);
        const double q_ext = 2 * (sums.spheres.scattered + sums.spheres.absorbed) / ensemble.share;
        const double change = before > 0.0 ? std::abs(q_ext / before - 1) : 1.0;
        const double exact = passes.exact_q_ext();
        const double missed = exact > 0 ? std::abs(q_ext / exact - 1) : change;
        error = passes.is_first() ? 1.0 : passes.error(change, missed, 0.25, 0.0, 1e-13);
        before = q_ext;
        const double last = std::exchange(absorbed, sums.spheres.absorbed);
        if (last > 0.0 && absorbed > 0.0) absorption_error = std::abs(std::log(absorbed / last));
        if (error <= RadiiRule::kShareOfTolerance * request.tolerance ||
            passes.sizes_so_far() >= most || !passes.refine())
            break;
    }
    const bool is_smooth = passes.rule() == Rule::smooth;
    const int wanted = RadiiRule::kTimesAsManySizes * passes.sizes_so_far();
    const int count = std::max(
        16, int(std::min({double(wanted), most,
                          double(is_smooth ? RadiiRule::kMostSmooth : RadiiRule::kMostSizes)})));
    const SizeNodes nodes = is_smooth ? smooth_size_nodes(request.sizes, ensemble.range, count)
                                      : even_size_nodes(request.sizes, ensemble.range, count, 0.5);
    const auto density = area_density(request.sizes);
    Radii radii{passes.rule(), nodes.radius_um, {}, absorption_error};
    for (std::size_t i = 0; i < nodes.radius_um.size(); ++i)
        radii.length_um.push_back(nodes.area_share[i] / density->at(nodes.radius_um[i]));
    return radii;
}

FixedRadii::FixedRadii(const EnsembleRequest& middle, const Radii& radii)
    : ensemble_(ensemble_of(middle)),
      n_(middle.refractive_index.real()),
      radii_(radii),
      has_ends_(radii.rule != Rule::single && ensemble_.law().has_ends) {
    for (std::size_t i = 0; i < radii.radius_um.size(); ++i)
        places_.push_back({radii.radius_um[i], radii.length_um[i], 0.0, 0.0});
    if (has_ends_) {
        const auto add = [&](double end_um, double Place::*share) {
            const SizeNodes nodes = nodes_at_end(ensemble_, end_um, radii.rule);
            for (std::size_t i = 0; i < nodes.radius_um.size(); ++i) {
                Place& place = places_.emplace_back(Place{nodes.radius_um[i], 0.0, 0.0, 0.0});
                place.*share = nodes.area_share[i];
            }
        };
        add(ensemble_.range.smallest_um, &Place::of_smallest);
        add(ensemble_.range.largest_um, &Place::of_largest);
        std::stable_sort(places_.begin(), places_.end(),
                         [](const Place& a, const Place& b) { return a.radius_um < b.radius_um; });
    }
}

std::vector<double> FixedRadii::radius_um() const {
    std::vector<double> all;
    all.reserve(places_.size());
    for (const Place& place : places_) all.push_back(place.radius_um);
    return all;
}

SpheresAtRadii FixedRadii::spheres(const EnsembleRequest& request) const {
    const Ensemble own = ensemble_of(request);
    SpheresAtRadii at{own.scatterer, own.wave_number_per_um, {}};
    if (radii_.rule == Rule::single) {
        at.x_per_um *= own.range.largest_um / ensemble_.range.largest_um;
        at.area_share = {1.0};
        return at;
    }
    const auto density = area_density(request.sizes);
    const auto gained = [&](double end_um, double by_um) {
        return by_um == 0.0 ? 0.0 : by_um * density->at(end_um);
    };
    const RadiusRange &range = ensemble_.range, &other = own.range;
    const double above =
        has_ends_ ? gained(range.largest_um, other.largest_um - range.largest_um) : 0.0;
    const double below =
        has_ends_ ? gained(range.smallest_um, range.smallest_um - other.smallest_um) : 0.0;
    at.area_share.reserve(places_.size());
    for (const Place& place : places_) {
        const double inside =
            place.length_um > 0.0 ? place.length_um * density->at(place.radius_um) : 0.0;
        at.area_share.push_back(inside + above * place.of_largest + below * place.of_smallest);
    }
    return at;
}

EnsembleRequest FixedRadii::with_resonances(EnsembleRequest side) const {
    const double larger = side.refractive_index.real() / n_;
    if (radii_.rule == Rule::even && ensemble_.law().analytic && !has_ends_ &&
        ensemble_.scatterer.is_plain() && side.coatings.empty()) {
        side.sizes.effective_radius_um *= larger;
        side.wavelength_nm *= larger;
    }
    return side;
}

SpheresChange FixedRadii::change(const EnsembleChange& of) const {
    SpheresChange change{spheres(with_resonances(of.plus)), spheres(with_resonances(of.minus)),
                         false};
    const auto numbers = [](const SpheresAtRadii& s) {
        std::vector<double> all{s.x_per_um, s.scatterer.relative_index.real(),
                                s.scatterer.relative_index.imag()};
        for (const Scatterer::Coating& c : s.scatterer.coatings)
            all.insert(all.end(),
                       {c.relative_index.real(), c.relative_index.imag(), c.thickness, c.share});
        return all;
    };
    change.spheres_differ = numbers(change.plus) != numbers(change.minus);
    return change;
}

}  // namespace miebrdf::mie
