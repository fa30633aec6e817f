#include "mie/ensemble/phase_tabulation.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>
#include <utility>
#include <vector>

#include "mie/ensemble/phase_panel.h"
#include "mie/ensemble/phase_table.h"
#include "mie/sphere/radial_functions.h"

namespace miebrdf::mie {
namespace {

constexpr int kBothFamilies = -1;

constexpr double kPartShare = 0.25;   // of the tolerance, for one part of several
constexpr double kSmoothShare = 0.1;  // of that of interpolation, for one part of several
// What is asked of glories decides whether directions back to the light converge, and costs little
// by rays.
constexpr double kBackwardShare = 0.45;
constexpr double kCoarseShare = 0.3;  // of the tolerance, while sizes do not resolve exp(2i x)

// Noise of single points gives most to the lowest moments: more of them are not looked at.
constexpr int kMomentsToJudge = 400;

// Ripple at one angle has a few frequencies in size. Where both families together are in step with
// one of them, each errs by the same and their difference says nothing; that of panels beside it
// does.
constexpr std::size_t kNeighbours = 3;

// Largest noise of each panel and its neighbours to both sides.
// @param panels  ascending
std::vector<double> noise_around(const std::vector<const PhasePanel*>& panels) {
    std::vector<double> noise;
    for (std::size_t i = 0; i < panels.size(); ++i) {
        double largest = 0;
        const std::size_t end = std::min(panels.size(), i + kNeighbours + 1);
        for (std::size_t j = i - std::min(i, kNeighbours); j < end; ++j)
            largest = std::max(largest, panels[j]->noise());
        noise.push_back(largest);
    }
    return noise;
}

std::vector<const PhasePanel*> ascending(const std::vector<PhasePanel>& panels) {
    std::vector<const PhasePanel*> order;
    order.reserve(panels.size());
    for (const PhasePanel& panel : panels) order.push_back(&panel);
    std::sort(order.begin(), order.end(),
              [](const PhasePanel* a, const PhasePanel* b) { return a->lower() < b->lower(); });
    return order;
}

// Computes everything when it is made.
class PhaseTabulation {
  public:
    PhaseTabulation(std::complex<double> relative_index, const SizeDistribution& distribution,
                    const RadiusRange& range, double wave_number_per_um,
                    const PhaseTabulationOptions& options, const Executor& run);

    PhaseTable table() const;
    double moment_error() const;

  private:
    PhaseTable table_of(int family) const;
    std::vector<PhasePanel> take_next();
    std::vector<int> wanted_by(const PhasePanel& panel) const;
    /// @param panels  that want the same
    void add_level(std::vector<PhasePanel> panels);
    /// @param noise  of the panel and those beside it
    bool needs_more_sizes(const PhasePanel& panel, double noise) const;
    void sort_in(PhasePanel panel, double noise);

    SizeFamilies sizes_;
    PhaseTabulationOptions options_;
    const Executor& run_;
    int terms_;
    double narrowest_;  // panel, in radians
    std::vector<PhasePanel> active_, done_;
};

PhaseTabulation::PhaseTabulation(std::complex<double> relative_index,
                                 const SizeDistribution& distribution, const RadiusRange& range,
                                 double wave_number_per_um, const PhaseTabulationOptions& options,
                                 const Executor& run)
    : sizes_(relative_index, distribution, range, wave_number_per_um, options.size_tolerance,
             options.by_rays ? SizeFamilies::Method::rays : SizeFamilies::Method::sizes),
      options_(options),
      run_(run),
      terms_(number_of_terms(wave_number_per_um * range.largest_um)),
      // P is a trigonometric polynomial of degree 2 x: nothing is finer than pi / x.
      narrowest_(std::numbers::pi / (wave_number_per_um * range.largest_um)) {
    sizes_.keep_waves();
    // Straight back all degrees of P add up, and what a polynomial has beyond the highest moment is
    // missing: with rays, that would be more than their noise.
    active_ = graded_panels(narrowest_, options.by_rays ? 0.5 * narrowest_ : narrowest_);
    while (!active_.empty()) add_level(take_next());
}

// Panels that want the same levels next: halves wait until all of their generation are there,
// because waves that are not kept are computed anew for each call.
std::vector<PhasePanel> PhaseTabulation::take_next() {
    const auto order = [&](const PhasePanel& panel) {
        return std::tuple(panel.generation(), panel.level(), wanted_by(panel));
    };
    auto first = order(active_.front());
    for (const PhasePanel& panel : active_) first = std::min(first, order(panel));
    std::vector<PhasePanel> next, others;
    for (PhasePanel& panel : active_) {
        (order(panel) == first ? next : others).push_back(std::move(panel));
    }
    active_ = std::move(others);
    return next;
}

std::vector<int> PhaseTabulation::wanted_by(const PhasePanel& panel) const {
    return panel.next_levels(sizes_, kPartShare * options_.size_tolerance);
}

void PhaseTabulation::add_level(std::vector<PhasePanel> panels) {
    std::sort(panels.begin(), panels.end(),
              [](const PhasePanel& a, const PhasePanel& b) { return a.lower() < b.lower(); });
    // Neighbours share the node at their edge.
    std::vector<double> angles_deg;
    std::vector<Eigen::Index> first;
    for (std::size_t p = 0; p < panels.size(); ++p) {
        const bool shares = p > 0 && panels[p - 1].upper() == panels[p].lower();
        first.push_back(static_cast<Eigen::Index>(angles_deg.size()) - (shares ? 1 : 0));
        const std::vector<double> nodes = panel_nodes(panels[p].lower(), panels[p].upper());
        for (std::size_t i = shares ? 1 : 0; i < nodes.size(); ++i)
            angles_deg.push_back(std::clamp(nodes[i] * 180 / std::numbers::pi, 0.0, 180.0));
    }
    const AngularFunctionsOf<float> angular(angles_deg, terms_, run_);
    const std::vector<int> levels = wanted_by(panels.front());
    const std::vector<FamilyIntensity> sums = sizes_.levels(levels, angular, run_);
    for (std::size_t p = 0; p < panels.size(); ++p) {
        panels[p].add_level(at_some_angles(sums, first[p], PhaseTable::kPanelNodes), levels, sizes_,
                            options_);
    }
    const std::vector<double> noise = noise_around(ascending(panels));
    for (std::size_t p = 0; p < panels.size(); ++p) {
        const int level = panels[p].level();
        const bool tells = level > (options_.by_rays ? 1 : 0) && sizes_.resolves(level);
        const double judged = tells ? panels[p].noise() : noise[p];
        sort_in(std::move(panels[p]), judged);
    }
}

bool PhaseTabulation::needs_more_sizes(const PhasePanel& panel, double noise) const {
    if (panel.level() >= sizes_.last_level()) return false;
    double believed = sizes_.resolves(panel.level()) ? 1.0 : kCoarseShare;
    if (options_.by_rays && panel.is_backward()) believed = kBackwardShare;
    return noise > believed * options_.size_tolerance ||
           panel.moment_noise(options_.first_moment) > believed * options_.moment_tolerance;
}

void PhaseTabulation::sort_in(PhasePanel panel, double noise) {
    // Half a period of the fastest wave in P: eight nodes leave 1e-6 of that.
    const bool narrow = panel.upper() - panel.lower() <= 0.501 * narrowest_;
    // Noise alone shows as a tail of 0.8 of itself.
    const double of_noise = (options_.by_rays ? 1.3 : 2.0) * panel.tail_of_noise();
    if (panel.tail() > std::max(options_.interpolation_tolerance, of_noise) && !narrow) {
        const double smooth =
            kSmoothShare * options_.interpolation_tolerance * panel.values().maxCoeff();
        active_.push_back(panel.lower_half(smooth));
        active_.push_back(panel.upper_half(smooth));
    } else {
        (needs_more_sizes(panel, noise) ? active_ : done_).push_back(std::move(panel));
    }
}

// Half of what the families' moments differ, and what the polynomials leave out.
double PhaseTabulation::moment_error() const {
    double squares = 0;
    for (const PhasePanel& panel : done_) {
        squares += std::pow(panel.moment_tail(options_.first_moment), 2);
    }
    double noise = 0;
    if (sizes_.count() == 2) {
        const int last = std::min(options_.last_moment, options_.first_moment + kMomentsToJudge);
        const std::vector<double> a = table_of(0).moments(last, run_);
        const std::vector<double> b = table_of(1).moments(last, run_);
        for (int l = options_.first_moment; l <= last; ++l) {
            noise = std::max(noise, 0.5 * std::abs(a[l] - b[l]));
        }
    }
    return noise + std::sqrt(squares);
}

PhaseTable PhaseTabulation::table() const { return table_of(kBothFamilies); }

PhaseTable PhaseTabulation::table_of(int family) const {
    const std::vector<const PhasePanel*> panels = ascending(done_);
    std::vector<double> edges = {0};
    constexpr Eigen::Index last = PhaseTable::kPanelNodes - 1;
    Eigen::MatrixXd values(last + 1, static_cast<Eigen::Index>(panels.size()));
    // Of neighbours, the noisiest: in narrow panels all nodes may agree by chance.
    const std::vector<double> around = noise_around(panels);
    std::vector<double> noise;
    double interpolation_error = 0, size_error = 0;
    for (std::size_t p = 0; p < panels.size(); ++p) {
        const auto column = static_cast<Eigen::Index>(p);
        edges.push_back(panels[p]->upper());
        values.col(column) =
            family == kBothFamilies ? panels[p]->values() : panels[p]->values_of(family);
        if (p > 0) {
            const bool better = panels[p]->level() > panels[p - 1]->level();
            const double shared = better ? values(0, column) : values(last, column - 1);
            values(0, column) = values(last, column - 1) = shared;
        }
        interpolation_error = std::max(interpolation_error, panels[p]->tail());
        size_error = std::max(size_error, panels[p]->worst_noise());
        noise.push_back(
            panels[p]->level() == 0 && !options_.by_rays
                ? around[p]
                : std::max({panels[p > 0 ? p - 1 : p]->stated_noise(), panels[p]->stated_noise(),
                            panels[std::min(p + 1, panels.size() - 1)]->stated_noise()}));
    }
    return make_phase_table({.edges = std::move(edges),
                             .coefficients = {},
                             .interpolation_error = interpolation_error,
                             .size_error = size_error,
                             .noise = std::move(noise),
                             .noise_floor = options_.floor},
                            values);
}

}  // namespace

TabulatedPhase tabulate_phase(std::complex<double> relative_index,
                              const SizeDistribution& distribution, const RadiusRange& range,
                              double wave_number_per_um, const PhaseTabulationOptions& options,
                              const Executor& run) {
    const PhaseTabulation tabulation(relative_index, distribution, range, wave_number_per_um,
                                     options, run);
    const bool with_moments = options.last_moment >= options.first_moment;
    return {tabulation.table(), with_moments ? tabulation.moment_error() : 0.0};
}

}  // namespace miebrdf::mie
