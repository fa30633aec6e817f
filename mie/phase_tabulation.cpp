#include "mie/phase_tabulation.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "mie/size_refinement.h"
#include "mie/size_sums.h"
#include "mie/terms.h"

namespace miebrdf::mie {
namespace {

constexpr int largest_chunk_count = 8;
constexpr int least_chunk_size = 16;
constexpr int smooth_first_count = 64;  // sizes of level 0 where there is no ripple

// The finest levels (in x), reached by few panels: a bound on time, not on accuracy.
constexpr double finest_spacing = 0.1;
constexpr double default_tolerance = 1e-2;

// Sizes more than 0.85 ripple periods apart may all meet the same resonances, and two such halves
// agree by that: they are believed only this far.
constexpr double coarse_share = 0.3;
constexpr int first_resolved_level = 2;
constexpr double resolved_spacing = 0.8;  // in x, without ripple: exp(2i x) remains

}  // namespace

PhaseTabulation::PhaseTabulation(std::complex<double> relative_index,
                                 const SizeDistribution& distribution, const RadiusRange& range,
                                 double wave_number_per_um, const PhaseTabulationOptions& options,
                                 const Executor& run)
    : relative_index_(relative_index),
      distribution_(distribution),
      range_(range),
      wave_number_per_um_(wave_number_per_um),
      options_(options),
      run_(run),
      // P is a trigonometric polynomial of degree 2 x: nothing is finer than pi / x.
      narrowest_(std::numbers::pi / (wave_number_per_um * range.largest_um)) {
    if (distribution.kind != SizeDistributionKind::mono) plan_levels();
    active_ = graded_panels(narrowest_);
    while (!active_.empty()) add_level(take_next());
}

void PhaseTabulation::plan_levels() {
    const double width = wave_number_per_um_ * (range_.largest_um - range_.smallest_um);
    rippled_ =
        !(relative_index_.imag() * wave_number_per_um_ * effective_radius_of(distribution_) > 1);
    first_count_ = smooth_first_count;
    resolved_level_ = first_resolved_level;
    if (rippled_) {
        first_count_ = std::max(first_count_, coarsest_even_count(relative_index_.real(), width));
    } else {
        const double levels = std::log2(width / (resolved_spacing * first_count_));
        resolved_level_ = std::max(0, static_cast<int>(std::ceil(levels)));
    }
    const double finer =
        std::min(1.0, std::pow(options_.size_tolerance / default_tolerance, 1 / 1.5));
    const double most = std::clamp(width / (finest_spacing * finer), 4096.0, double(node_limit));
    while (first_count_ << (last_level_ + 1) <= most) ++last_level_;
}

// Panels that share the next level of sizes: halves wait until all of their generation are there,
// because the spheres are computed anew for each call.
std::vector<PhasePanel> PhaseTabulation::take_next() {
    const auto order = [](const PhasePanel& panel) {
        return std::pair(panel.generation(), panel.level());
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

void PhaseTabulation::add_level(std::vector<PhasePanel> panels) {
    std::vector<double> angles_deg;
    for (const PhasePanel& panel : panels) {
        for (const double theta : PhaseTable::nodes_of(panel.lower(), panel.upper())) {
            angles_deg.push_back(std::clamp(theta * 180 / std::numbers::pi, 0.0, 180.0));
        }
    }
    const AngularFunctionsOf<float> angular(
        angles_deg, number_of_terms(wave_number_per_um_ * range_.largest_um), run_);
    const HalvedIntensity sums = sum_level(panels.front().level() + 1, angular);
    Eigen::Index first = 0;
    for (PhasePanel& panel : panels) {
        panel.add_level(sums.intensity.middleRows(first, PhaseTable::panel_nodes), sums.scattered,
                        rippled_, options_.scattering_efficiency, options_.floor);
        first += PhaseTable::panel_nodes;
        sort_in(std::move(panel));
    }
}

HalvedIntensity PhaseTabulation::sum_level(int level,
                                           const AngularFunctionsOf<float>& angular) const {
    SizeNodes nodes{{range_.largest_um}, {1.0}};
    if (distribution_.kind != SizeDistributionKind::mono) {
        nodes =
            nested_size_nodes(distribution_, range_, first_count_, level, SizeSpacing::geometric);
    }
    const WeightedSizes sizes(nodes, wave_number_per_um_);
    const SizeChunks chunks(static_cast<int>(sizes.parameters.size()), largest_chunk_count,
                            least_chunk_size);
    std::vector<HalvedIntensity> parts(chunks.count());
    run_(chunks.count(), [&](int job) {
        const int chunk = chunks.count() - 1 - job;  // large spheres first
        HalvedIntensity& part = parts[chunk];
        part.intensity = Eigen::MatrixXd::Zero(angular.angle_count(), 2);
        SphereBlockOf<float> block;
        block.make_room(number_of_terms(sizes.parameters.back()), most_sizes_per_block);
        for (const auto [first, count] : chunks.blocks(chunk)) {
            const std::size_t here = count;
            const SphereSums sums =
                compute_spheres(relative_index_, {sizes.parameters.data() + first, here},
                                {sizes.weights.data() + first, here}, &block);
            angular.add_intensity(block, part.intensity);
            part.scattered[0] += 2 * (sums.scattered - sums.scattered_at_odd);
            part.scattered[1] += 2 * sums.scattered_at_odd;
        }
    });
    HalvedIntensity total = std::move(parts[0]);
    for (int chunk = 1; chunk < chunks.count(); ++chunk) {
        total.intensity += parts[chunk].intensity;
        for (int half : {0, 1}) total.scattered[half] += parts[chunk].scattered[half];
    }
    return total;
}

bool PhaseTabulation::needs_more_sizes(const PhasePanel& panel) const {
    if (panel.level() >= last_level_) return false;
    const double believed = panel.level() < resolved_level_ ? coarse_share : 1.0;
    return panel.noise() > believed * options_.size_tolerance ||
           panel.moment_error(options_.first_moment) > believed * options_.moment_tolerance;
}

void PhaseTabulation::sort_in(PhasePanel panel) {
    // Half a period of the fastest wave in P: eight nodes leave 1e-6 of that.
    const bool narrow = panel.upper() - panel.lower() <= 0.501 * narrowest_;
    // Noise alone shows as a tail of 0.8 of itself.
    if (panel.tail() > std::max(options_.interpolation_tolerance, 2 * panel.tail_of_noise()) &&
        !narrow) {
        const double middle = 0.5 * (panel.lower() + panel.upper());
        active_.emplace_back(panel.lower(), middle, panel.generation() + 1);
        active_.emplace_back(middle, panel.upper(), panel.generation() + 1);
    } else {
        (needs_more_sizes(panel) ? active_ : done_).push_back(std::move(panel));
    }
}

double PhaseTabulation::moment_error() const {
    double squares = 0;
    for (const PhasePanel& panel : done_) {
        squares += std::pow(panel.moment_error(options_.first_moment), 2);
    }
    return std::sqrt(squares);
}

PhaseTable PhaseTabulation::table() const {
    std::vector<const PhasePanel*> panels;
    for (const PhasePanel& panel : done_) panels.push_back(&panel);
    std::sort(panels.begin(), panels.end(),
              [](const PhasePanel* a, const PhasePanel* b) { return a->lower() < b->lower(); });
    std::vector<double> edges = {0};
    constexpr Eigen::Index last = PhaseTable::panel_nodes - 1;
    Eigen::MatrixXd values(last + 1, static_cast<Eigen::Index>(panels.size()));
    double interpolation_error = 0, size_error = 0;
    for (std::size_t p = 0; p < panels.size(); ++p) {
        const auto column = static_cast<Eigen::Index>(p);
        edges.push_back(panels[p]->upper());
        values.col(column) = panels[p]->values();
        if (p > 0) {
            const bool better = panels[p]->level() > panels[p - 1]->level();
            const double shared = better ? values(0, column) : values(last, column - 1);
            values(0, column) = values(last, column - 1) = shared;
        }
        interpolation_error = std::max(interpolation_error, panels[p]->tail());
        size_error = std::max(size_error, panels[p]->worst_noise());
    }
    return PhaseTable(std::move(edges), values, interpolation_error, size_error);
}

}  // namespace miebrdf::mie
