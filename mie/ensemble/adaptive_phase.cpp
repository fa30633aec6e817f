#include "mie/ensemble/adaptive_phase.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <tuple>
#include <utility>
#include <vector>

#include "mie/ensemble/phase_table.h"

namespace miebrdf::mie {
namespace {

// docs/maths-mie.md#phase-function and docs/internals/mie-log.md have the measurements.
// docs/internals/constants.md says what each constant does.
struct Refinement {
    /// White noise of rms s at the nodes gives last Chebyshev coefficients of 0.8 s: such a tail is
    /// no reason to halve a panel.
    static constexpr double kTailOfNoise = 1.3;
    /// Half a period of the fastest wave in P: eight nodes leave 1e-6 of that.
    static constexpr double kNarrowest = 0.501;
    /// Ripple at one angle has a few frequencies in size. Where both samples together are in step
    /// with one of them, each errs by the same and their difference says nothing; that of so many
    /// panels to both sides does.
    static constexpr std::size_t kNeighbours = 3;
};

struct Point {
    std::size_t index;  // in the list of angles
    double theta;       // radians
};

// A panel with the points that are wanted on it; a table wants all of it and has none.
struct Place {
    PhasePanel panel;
    std::vector<Point> points = {};

    Eigen::VectorXd coefficients = {};  // of P so far

    double value_at(const Point& point) const {
        return panel_value(coefficients.data(),
                           (2 * point.theta - panel.lower() - panel.upper()) / panel.width());
    }
};

// A panel is asked for noise relative to max(P, floor), and for an absolute error of interpolation.
struct Demand {
    double noise, interpolation;
};

// Largest noise of each panel and its neighbours to both sides.
// @param panels  ascending
std::vector<double> noise_around(const std::vector<const PhasePanel*>& panels) {
    std::vector<double> noise;
    for (std::size_t i = 0; i < panels.size(); ++i) {
        double largest = 0;
        const std::size_t end = std::min(panels.size(), i + Refinement::kNeighbours + 1);
        for (std::size_t j = i - std::min(i, Refinement::kNeighbours); j < end; ++j)
            largest = std::max(largest, panels[j]->noise());
        noise.push_back(largest);
    }
    return noise;
}

// Takes levels of sizes and halves panels until all are done.
class PanelRefinement {
  public:
    virtual ~PanelRefinement() = default;

  protected:
    PanelRefinement(const Ensemble& ensemble, const PhaseGoal& goal, const Executor& run)
        : ensemble_(ensemble), goal_(goal), run_(run), sizes_(ensemble, goal.method) {
        // Rays have no bound on their work, but a finest level that is soon there.
        if (by_rays()) goal_.most_work = std::numeric_limits<double>::infinity();
    }

    bool by_rays() const { return goal_.method != PhaseMethod::sizes; }

    virtual Demand demand_of(const Place& place) const = 0;
    /// Whether the polynomials of this level may tell that a panel is too wide.
    virtual bool may_halve(const PhasePanel&) const { return true; }
    /// @param noise  of the panel and of those beside it
    virtual bool is_enough(const Place& place, double noise, double demanded) const = 0;
    virtual void accept(Place place) = 0;

    void refine(std::vector<Place> places) {
        active_ = std::move(places);
        while (!active_.empty()) add_level(take_next());
    }

    const Ensemble& ensemble_;
    PhaseGoal goal_;
    const Executor& run_;
    PairedSizeSamples sizes_;
    bool in_double_ = false;

  private:
    // Panels that want the same levels next: halves wait until all of their generation are there,
    // because waves that are not kept are computed anew for each call.
    std::vector<Place> take_next() {
        const auto order = [this](const Place& place) {
            return std::tuple(place.panel.generation(), place.panel.level(), wanted_by(place));
        };
        auto first = order(active_.front());
        for (const Place& place : active_) first = std::min(first, order(place));
        std::vector<Place> next, others;
        for (Place& place : active_)
            (order(place) == first ? next : others).push_back(std::move(place));
        active_ = std::move(others);
        return next;
    }

    std::vector<int> wanted_by(const Place& place) const {
        const double demanded = place.panel.level() < 0 ? std::numeric_limits<double>::infinity()
                                                        : demand_of(place).noise;
        return place.panel.next_levels(sizes_, AverageLimits::kPartShare * demanded);
    }

    /// @param places  that want the same
    void add_level(std::vector<Place> places) {
        std::sort(places.begin(), places.end(),
                  [](const Place& a, const Place& b) { return a.panel.lower() < b.panel.lower(); });
        // Neighbours share the node at their edge.
        std::vector<double> angles_deg;
        std::vector<Eigen::Index> first;
        for (std::size_t p = 0; p < places.size(); ++p) {
            const PhasePanel& panel = places[p].panel;
            const std::size_t shared =
                p > 0 && places[p - 1].panel.upper() == panel.lower() ? 1 : 0;
            first.push_back(static_cast<Eigen::Index>(angles_deg.size() - shared));
            const std::vector<double> nodes = panel_nodes(panel.lower(), panel.upper());
            for (std::size_t i = shared; i < nodes.size(); ++i)
                angles_deg.push_back(std::clamp(nodes[i] * 180 / std::numbers::pi, 0.0, 180.0));
        }
        const std::vector<int> levels = wanted_by(places.front());
        const auto sums = sizes_.levels(levels, angles_deg, in_double_, run_);
        std::vector<const PhasePanel*> panels;
        for (std::size_t p = 0; p < places.size(); ++p) {
            PhasePanel& panel = places[p].panel;
            panel.add_level(at_some_angles(sums, first[p], PhaseTable::kPanelNodes), levels, sizes_,
                            goal_);
            places[p].coefficients = panel_coefficients(panel.values());
            panels.push_back(&panel);
        }
        work_ = double(angles_deg.size()) * ensemble_.terms();
        const std::vector<double> around = noise_around(panels);
        for (std::size_t p = 0; p < places.size(); ++p) sort_in(std::move(places[p]), around[p]);
    }

    void sort_in(Place place, double noise_around) {
        const PhasePanel& panel = place.panel;
        const Demand demand = demand_of(place);
        const double of_noise = Refinement::kTailOfNoise * panel.tail_of_noise();
        const double largest = panel.values().maxCoeff();
        const bool narrow = panel.width() <= Refinement::kNarrowest * ensemble_.finest_angle();
        if (!narrow && may_halve(panel) &&
            panel.tail() > std::max(demand.interpolation / largest, of_noise)) {
            halve(place, AverageLimits::kPartShare * demand.interpolation);
        } else if (panel.level() >= sizes_.last_level() || gains_nothing(panel) ||
                   work_ * sizes_.sizes_at(panel.level() + 1) > goal_.most_work ||
                   is_enough(place, noise_around, demand.noise)) {
            accept(std::move(place));
        } else {
            active_.push_back(std::move(place));
        }
    }

    // Most of the noise by rays is then what they leave out, which more sizes do not remove.
    bool gains_nothing(const PhasePanel& panel) const {
        return panel.level() > 0 &&
               panel.noise() * panel.noise() <= 2 * panel.bias() * panel.bias();
    }

    void halve(const Place& place, double smooth) {
        Place low{place.panel.lower_half(smooth)}, high{place.panel.upper_half(smooth)};
        for (const Point& point : place.points)
            (point.theta < place.panel.middle() ? low : high).points.push_back(point);
        for (Place* half : {&low, &high}) {
            if (place.points.empty() || !half->points.empty()) active_.push_back(std::move(*half));
        }
    }

    std::vector<Place> active_ = {};
    double work_ = 0;  // angles of the last level times partial waves
};

class Tabulation : public PanelRefinement {
  public:
    Tabulation(const Ensemble& ensemble, const PhaseGoal& goal, const Executor& run)
        : PanelRefinement(ensemble, goal, run) {
        std::vector<Place> places;
        // Straight back all degrees of P add up, and what a polynomial has beyond the highest
        // moment is missing: with rays, that would be more than their noise.
        const double narrowest = ensemble.finest_angle();
        for (PhasePanel& panel : graded_panels(narrowest, by_rays() ? 0.5 * narrowest : narrowest))
            places.push_back({std::move(panel)});
        refine(std::move(places));
        std::sort(done_.begin(), done_.end(),
                  [](const PhasePanel& a, const PhasePanel& b) { return a.lower() < b.lower(); });
    }

    PhaseTable table() const { return table_of({}); }
    double moment_error() const;

  private:
    Demand demand_of(const Place& place) const override {
        return {goal_.size_tolerance,
                goal_.interpolation_tolerance * place.panel.values().maxCoeff()};
    }

    bool is_enough(const Place& place, double noise_around, double demanded) const override {
        const PhasePanel& panel = place.panel;
        const int level = panel.level();
        const bool tells = level > (by_rays() ? 1 : 0) && sizes_.resolves(level);
        return (tells ? panel.noise() : noise_around) <= demanded &&
               panel.moment_noise(goal_.first_moment) <= goal_.moment_tolerance;
    }

    void accept(Place place) override { done_.push_back(std::move(place.panel)); }

    /// @param sample  0 or 1; none: both
    PhaseTable table_of(std::optional<int> sample) const;

    std::vector<PhasePanel> done_;  // ascending in the end
};

// Half of what the samples' moments differ, and what the polynomials leave out.
double Tabulation::moment_error() const {
    double squares = 0;
    for (const PhasePanel& panel : done_)
        squares += std::pow(panel.moment_tail(goal_.first_moment), 2);
    double noise = 0;
    if (sizes_.count() == 2) {
        // Noise of single points gives most to the lowest moments: more are not looked at.
        const int last =
            std::min(goal_.last_moment, goal_.first_moment + AverageLimits::kMostBandWidth);
        const std::vector<double> a = table_of(0).moments(last, run_);
        const std::vector<double> b = table_of(1).moments(last, run_);
        for (int l = goal_.first_moment; l <= last; ++l)
            noise = std::max(noise, 0.5 * std::abs(a[l] - b[l]));
    }
    return noise + std::sqrt(squares);
}

PhaseTable Tabulation::table_of(std::optional<int> sample) const {
    std::vector<const PhasePanel*> panels;
    for (const PhasePanel& panel : done_) panels.push_back(&panel);
    std::vector<double> edges = {0};
    constexpr Eigen::Index last = PhaseTable::kPanelNodes - 1;
    Eigen::MatrixXd values(last + 1, static_cast<Eigen::Index>(panels.size()));
    // In narrow panels all nodes may agree by chance: the noisiest of neighbours counts.
    const std::vector<double> around = noise_around(panels);
    std::vector<double> noise;
    double interpolation_error = 0, size_error = 0;
    for (std::size_t p = 0; p < panels.size(); ++p) {
        const auto column = static_cast<Eigen::Index>(p);
        edges.push_back(panels[p]->upper());
        values.col(column) = sample ? panels[p]->values_of(*sample) : panels[p]->values();
        if (p > 0) {
            const bool better = panels[p]->level() > panels[p - 1]->level();
            const double shared = better ? values(0, column) : values(last, column - 1);
            values(0, column) = values(last, column - 1) = shared;
        }
        interpolation_error = std::max(interpolation_error, panels[p]->tail());
        size_error = std::max(size_error, panels[p]->worst_noise());
        noise.push_back(panels[p]->level() == 0 && !by_rays()
                            ? around[p]
                            : std::max({panels[p > 0 ? p - 1 : p]->noise(), panels[p]->noise(),
                                        panels[std::min(p + 1, panels.size() - 1)]->noise()}));
    }
    return make_phase_table({.edges = std::move(edges),
                             .coefficients = {},
                             .interpolation_error = interpolation_error,
                             .size_error = size_error,
                             .noise = std::move(noise),
                             .noise_floor = goal_.floor},
                            values, goal_.least_noise);
}

// The error that is allowed at points.
struct Allowance {
    const std::vector<double>& absolute;  // empty: relative
    double relative, floor;

    bool is_absolute() const { return !absolute.empty(); }
    double at(const Point& point, double value) const {
        return is_absolute() ? absolute[point.index] : relative * std::max(value, floor);
    }
};

class PointSeries : public PanelRefinement {
  public:
    PointSeries(const Ensemble& ensemble, const PhaseGoal& goal, const Executor& run,
                const Allowance& allowance, PhaseValues& result)
        : PanelRefinement(ensemble, goal, run), allowance_(allowance), result_(result) {
        in_double_ = !by_rays() && !may_be_single(ensemble, goal.size_tolerance);
        if (allowance.is_absolute()) goal_.floor = AverageLimits::kDim;
    }

    void compute(std::vector<Place> places) { refine(std::move(places)); }

  private:
    // The error per noise of the panel.
    double deviations(double value) const {
        return AverageLimits::kDeviations * std::max(value, goal_.floor);
    }

    // The strictest of the points decides.
    Demand demand_of(const Place& place) const override {
        Demand demand{std::numeric_limits<double>::infinity(),
                      std::numeric_limits<double>::infinity()};
        for (const Point& point : place.points) {
            const double value = place.value_at(point), allowed = allowance_.at(point, value);
            if (!(std::max(value, goal_.floor) > 0)) return {0, 0};  // not to be believed
            demand.noise = std::min(demand.noise, allowed / deviations(value));
            demand.interpolation =
                std::min(demand.interpolation, AverageLimits::kPartShare * allowed);
        }
        return demand;
    }

    // Panels have no neighbours to be judged by, and samples of the first level of ripple may agree
    // by chance.
    bool may_halve(const PhasePanel& panel) const override {
        return !sizes_.rippled() || panel.level() > 0;
    }

    bool is_enough(const Place& place, double, double demanded) const override {
        const PhasePanel& panel = place.panel;
        return may_halve(panel) && sizes_.resolves(panel.level()) && panel.noise() <= demanded;
    }

    void accept(Place place) override {
        for (const Point& point : place.points) {
            const double value = place.value_at(point);
            const double error =
                std::max(deviations(value) * place.panel.noise(), 0.5 * place.panel.tail() * value);
            // Sizes are added until the error is what is allowed: less is small by chance, or by
            // the last doubling. The geometric mean of both lies between.
            const double stated = std::max(error, std::sqrt(error * allowance_.at(point, value)));
            // A bounded number of sizes may do worse than rays have done.
            double& known = result_.error[point.index];
            if (known > 0 && known < stated) continue;
            known = stated;
            result_.phase[point.index] = value;
        }
    }

    const Allowance& allowance_;
    PhaseValues& result_;
};

}  // namespace

TabulatedPhase AdaptivePhase::table() const {
    const Tabulation tabulation(ensemble_, goal_, run_);
    const bool with_moments = goal_.last_moment >= goal_.first_moment;
    return {tabulation.table(), with_moments ? tabulation.moment_error() : 0.0};
}

PhaseValues AdaptivePhase::at(const std::vector<double>& angles_deg,
                              const std::vector<double>& allowed) const {
    PhaseValues result{std::vector<double>(angles_deg.size()),
                       std::vector<double>(angles_deg.size())};
    if (ensemble_.law().single_size) {
        PairedSizeSamples one(ensemble_);
        const PairedIntensity all = one.levels({0}, angles_deg, true, run_).front();
        for (std::size_t i = 0; i < angles_deg.size(); ++i)
            result.phase[i] = all.intensity(Eigen::Index(i), 0) / all.scattered[0];
        return result;
    }
    const Allowance allowance{allowed, goal_.size_tolerance, goal_.floor};
    const auto compute = [&](bool by_rays, std::vector<Place> places) {
        if (places.empty()) return;
        PhaseGoal goal = goal_;
        if (!by_rays) {
            goal.method = PhaseMethod::sizes;
            goal.ray_bias = {};
        }
        PointSeries(ensemble_, goal, run_, allowance, result).compute(std::move(places));
    };
    // P is not known yet: what is dark is held to the floor.
    const double bias =
        AverageLimits::kDeviations * goal_.ray_bias.everywhere * AverageLimits::kDim;
    const auto too_biased = [&](const Point& point, double value) {
        return !(bias <= allowance.at(point, value));
    };
    const auto places_of = [&](const auto& is_wanted) {
        std::vector<Place> places;
        for (PhasePanel& panel : graded_panels(ensemble_.finest_angle(), ensemble_.finest_angle()))
            places.push_back({std::move(panel)});
        for (std::size_t i = 0; i < angles_deg.size(); ++i) {
            const Point point{i, angles_deg[i] * std::numbers::pi / 180};
            if (!is_wanted(point)) continue;
            const auto place =
                std::find_if(places.begin(), places.end() - 1,
                             [&](const Place& one) { return point.theta <= one.panel.upper(); });
            place->points.push_back(point);
        }
        std::erase_if(places, [](const Place& place) { return place.points.empty(); });
        return places;
    };
    const auto by_rays = [&](const Point& point) {
        return goal_.method != PhaseMethod::sizes && !too_biased(point, AverageLimits::kDim);
    };
    compute(true, places_of(by_rays));
    compute(false, places_of([&](const Point& point) {
                if (!by_rays(point)) return true;
                // Who says what is allowed adds up errors of several points, by their rms.
                const double value = result.phase[point.index];
                return !allowance.is_absolute() && too_biased(point, value) &&
                       result.error[point.index] > allowance.at(point, value);
            }));
    return result;
}

}  // namespace miebrdf::mie
