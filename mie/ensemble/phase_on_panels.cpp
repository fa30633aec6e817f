// P at many angles: where they lie close together, a polynomial through the nodes of a panel takes
// fewer angles than three for each of them.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <tuple>
#include <utility>
#include <vector>

#include "mie/ensemble/phase_panel.h"
#include "mie/ensemble/phase_table.h"
#include "mie/ensemble/phase_tabulation.h"
#include "mie/sphere/radial_functions.h"

namespace miebrdf::mie {
namespace {

// Three angles for each point are more than the nodes of a panel, which shares one of them.
constexpr std::size_t kFewPoints = 3;
// Of an rms over the nodes of a panel.
constexpr double kDeviations = 2.5;
// Times that, as far as this share of what is allowed: what is stated costs nothing.
constexpr double kStated = 3, kStatedShare = 0.5;
// What comes back from glories is narrower than what the families of few sizes tell.
constexpr double kBackwardDeviations = 3;
constexpr double kInterpolationShare = 0.25;  // of what is allowed
constexpr double kPartShare = 0.25;           // of what is allowed, for one part of several
constexpr double kSmoothShare = 0.1;          // of that of interpolation, for one part of several
constexpr double kBiasShare = 0.5;            // of what is allowed, for what rays leave out
constexpr double kFinest = 1e-6;
constexpr double kFloor = 0.5;  // noise is relative to max(P, this)
// Panels that do not wait for the level before: families may agree by chance.
constexpr int kLeastLevel = 1;

struct Point {
    std::size_t index;  // in the list of angles
    double theta;       // radians
};

// A panel with the points on it.
struct Place {
    PhasePanel panel;
    std::vector<Point> points;

    Eigen::VectorXd coefficients = {};  // of P so far

    double value_at(double theta) const {
        const double width = panel.upper() - panel.lower();
        return panel_value(coefficients.data(),
                           (2 * theta - panel.lower() - panel.upper()) / width);
    }
    double error_at(double value) const {
        const double deviations = panel.is_backward() ? kBackwardDeviations : kDeviations;
        return deviations * panel.noise() * std::max(value, kFloor);
    }
};

class PanelSeries {
  public:
    PanelSeries(std::complex<double> relative_index, const SizeDistribution& distribution,
                const RadiusRange& range, double wave_number_per_um,
                const PhaseTabulationOptions& options, const std::vector<double>& allowed,
                PhaseValues& result)
        // Panels may go to the finest level of all: most_work is their bound.
        : sizes_(relative_index, distribution, range, wave_number_per_um, kFinest,
                 options.by_rays ? SizeFamilies::Method::exact_rays : SizeFamilies::Method::sizes),
          options_(options),
          allowed_(allowed),
          result_(result),
          terms_(number_of_terms(wave_number_per_um * range.largest_um)),
          narrowest_(std::numbers::pi / (wave_number_per_um * range.largest_um)) {
        options_.floor = kFloor;
        sizes_.keep_waves();
    }

    void compute(std::vector<Place> places, const Executor& run) {
        active_ = std::move(places);
        while (!active_.empty()) add_level(take_next(), run);
    }

  private:
    // Those that want the same levels of sizes next.
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
        return place.panel.next_levels(sizes_, kPartShare * relative_tolerance(place));
    }

    void add_level(std::vector<Place> places, const Executor& run) {
        std::vector<double> angles_deg;
        const std::vector<int> levels = wanted_by(places.front());
        for (const Place& place : places) {
            for (const double theta : panel_nodes(place.panel.lower(), place.panel.upper()))
                angles_deg.push_back(std::clamp(theta * 180 / std::numbers::pi, 0.0, 180.0));
        }
        const std::vector<FamilyIntensity> sums =
            sizes_.levels(levels, AngularFunctionsOf<float>(angles_deg, terms_, run), run);
        Eigen::Index first = 0;
        for (Place& place : places) {
            place.panel.add_level(at_some_angles(sums, first, PhaseTable::kPanelNodes), levels,
                                  sizes_, options_);
            first += PhaseTable::kPanelNodes;
            place.coefficients = panel_coefficients(place.panel.values());
            sort_in(std::move(place), double(angles_deg.size()));
        }
    }

    // Of the noise of a panel, relative to max(P, floor): what the strictest of its points allows.
    double relative_tolerance(const Place& place) const {
        double least = std::numeric_limits<double>::infinity();
        if (place.panel.level() < 0) return least;
        for (const Point& point : place.points) {
            const double value = std::max(place.value_at(point.theta), kFloor);
            least = std::min(least, allowed_[point.index] / place.error_at(value));
        }
        return least * place.panel.noise();
    }

    void sort_in(Place place, double angle_count) {
        const PhasePanel& panel = place.panel;
        bool is_enough = panel.level() >= kLeastLevel && sizes_.resolves(panel.level());
        double strictest = std::numeric_limits<double>::infinity();
        for (const Point& point : place.points) {
            const double value = place.value_at(point.theta);
            strictest = std::min(strictest, allowed_[point.index]);
            is_enough = is_enough && place.error_at(value) <= allowed_[point.index];
        }
        const double tail = panel.tail() * panel.values().maxCoeff();
        const bool narrow = panel.upper() - panel.lower() <= 0.501 * narrowest_;
        const bool is_rough = panel.level() >= kLeastLevel && !narrow &&
                              panel.tail() > 2 * panel.tail_of_noise() &&
                              tail > kInterpolationShare * strictest;
        if (is_rough) {
            halve(place, kSmoothShare * kInterpolationShare * strictest);
        } else if (is_enough || panel.level() >= sizes_.last_level() ||
                   is_too_much(angle_count, panel.level())) {
            put(place);
        } else {
            active_.push_back(std::move(place));
        }
    }

    bool is_too_much(double angle_count, int level) const {
        return !options_.by_rays &&
               angle_count * terms_ * sizes_.sizes_at(level + 1) > options_.most_work;
    }

    void halve(const Place& place, double smooth) {
        const PhasePanel& panel = place.panel;
        Place low{panel.lower_half(smooth), {}}, high{panel.upper_half(smooth), {}};
        for (const Point& point : place.points)
            (point.theta < panel.middle() ? low : high).points.push_back(point);
        for (Place* half : {&low, &high}) {
            if (!half->points.empty()) active_.push_back(std::move(*half));
        }
    }

    void put(const Place& place) {
        for (const Point& point : place.points) {
            const double value = place.value_at(point.theta);
            const double interpolation = 0.5 * place.panel.tail() * value;
            const double error = std::max(place.error_at(value), interpolation);
            const double most = kStatedShare * allowed_[point.index];
            result_.phase[point.index] = value;
            result_.error[point.index] = std::max(error, std::min(kStated * error, most));
        }
    }

    SizeFamilies sizes_;
    PhaseTabulationOptions options_;
    const std::vector<double>& allowed_;
    PhaseValues& result_;
    int terms_;
    double narrowest_;
    std::vector<Place> active_;
};

}  // namespace

std::vector<std::size_t> phase_on_panels(std::complex<double> relative_index,
                                         const SizeDistribution& distribution,
                                         const RadiusRange& range, double wave_number_per_um,
                                         const PhaseTabulationOptions& options,
                                         const std::vector<double>& angles_deg,
                                         const std::vector<double>& allowed, const Executor& run,
                                         PhaseValues& result) {
    std::vector<std::size_t> left;
    std::vector<Place> places;
    const double narrowest = std::numbers::pi / (wave_number_per_um * range.largest_um);
    for (PhasePanel& panel : graded_panels(narrowest, narrowest))
        places.push_back({std::move(panel), {}});
    for (std::size_t i = 0; i < angles_deg.size(); ++i) {
        const double theta = angles_deg[i] * std::numbers::pi / 180;
        const auto place = std::find_if(places.begin(), places.end() - 1, [&](const Place& one) {
            return theta <= one.panel.upper();
        });
        place->points.push_back({i, theta});
    }
    std::vector<Place> by_rays, by_sizes;
    for (Place& place : places) {
        if (place.points.size() <= kFewPoints) {
            for (const Point& point : place.points) left.push_back(point.index);
            continue;
        }
        double strictest = std::numeric_limits<double>::infinity();
        for (const Point& point : place.points)
            strictest = std::min(strictest, allowed[point.index]);
        // P is not known yet: what is dark is held to the floor.
        const double bias = kDeviations * options.ray_bias.everywhere * kFloor;
        const bool rays = options.by_rays && bias <= kBiasShare * strictest;
        (rays ? by_rays : by_sizes).push_back(std::move(place));
    }
    const auto compute = [&](const PhaseTabulationOptions& by, std::vector<Place> some) {
        PanelSeries series(relative_index, distribution, range, wave_number_per_um, by, allowed,
                           result);
        series.compute(std::move(some), run);
    };
    compute(options, std::move(by_rays));
    PhaseTabulationOptions sizes_alone = options;
    sizes_alone.by_rays = false;
    sizes_alone.ray_bias = {};
    compute(sizes_alone, std::move(by_sizes));
    return left;
}

}  // namespace miebrdf::mie
