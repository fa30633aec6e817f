#include "mie/ensemble/fixed_radii.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "mie/ensemble/size_refinement.h"
#include "mie/sizes/size_law.h"
#include "mie/sizes/size_nodes.h"

namespace miebrdf::mie {
namespace {

/// Radii around a sharp end of a law, by which what it gains there is told: the end alone where
/// spheres are smooth in size; else as many as see all phases of ripple and interference, with
/// weights that have no edges and no second moment: what is smooth there is the value at the end.
SizeNodes nodes_at_end(const Ensemble& ensemble, double end_um, bool is_even) {
    if (!is_even) return {{end_um}, {1.0}};
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
    // Efficiencies and g.
    class Summation : public SizeSummation {
      public:
        Summation(const EnsembleRequest& request, const Ensemble& ensemble, const Executor& run)
            : request_(request), ensemble_(ensemble), run_(run) {}
        SizeSums sum(const SizeNodes& nodes, bool) const override {
            return sum_over_sizes(ensemble_.scatterer,
                                  WeightedSizes(nodes, ensemble_.wave_number_per_um),
                                  {.terms = ensemble_.terms()}, run_);
        }
        Eigen::ArrayXd averages(const SizeSums&) const override { return {}; }
        double tolerance(const SphereSums&) const override {
            return stated_error(0, request_.tolerance);
        }

      private:
        const EnsembleRequest& request_;
        const Ensemble& ensemble_;
        const Executor& run_;
    };
    const Ensemble ensemble = ensemble_of(request);
    if (ensemble.law().single_size) return {{ensemble.range.largest_um}, {1.0}};
    const RefinedAverage average = refine_sizes(ensemble, Summation(request, ensemble, run),
                                                stated_error(0, request.tolerance),
                                                int(std::min(most, double(RadiiRule::kMostSizes))));
    const int wanted = RadiiRule::kTimesAsManySizes * average.sizes;
    const int count = std::max(SizeRule::kFirstGauss, int(std::min(double(wanted), most)));
    const SizeNodes nodes = average.is_smooth
                                ? smooth_size_nodes(request.sizes, ensemble.range, count)
                                : even_size_nodes(request.sizes, ensemble.range, count, 0.5);
    const auto density = area_density(request.sizes);
    Radii radii{nodes.radius_um, {}, !average.is_smooth};
    for (std::size_t i = 0; i < nodes.radius_um.size(); ++i)
        radii.length_um.push_back(nodes.area_share[i] / density->at(nodes.radius_um[i]));
    return radii;
}

FixedRadii::FixedRadii(const EnsembleRequest& middle, const Radii& radii)
    : ensemble_(ensemble_of(middle)),
      n_(middle.refractive_index.real()),
      radii_(radii),
      has_ends_(!ensemble_.law().single_size && ensemble_.law().has_ends) {
    for (std::size_t i = 0; i < radii.radius_um.size(); ++i)
        places_.push_back({radii.radius_um[i], radii.length_um[i], 0.0, 0.0});
    if (has_ends_) {
        const auto add = [&](double end_um, double Place::*share) {
            const SizeNodes nodes = nodes_at_end(ensemble_, end_um, radii.is_even);
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
    if (ensemble_.law().single_size) {
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
    if (radii_.is_even && ensemble_.law().is_without_bends && !has_ends_ &&
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
