#include "mie/phase_tabulation.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "mie/size_refinement.h"
#include "mie/size_sums.h"
#include "mie/terms.h"

namespace miebrdf::mie {
namespace {

constexpr int largest_chunk_count = 8;
constexpr int least_chunk_size = 16;
constexpr int smooth_first_count = 64;  // sizes of level 0 where there is no ripple

// Widths grow by this share of the distance from the nearer end, up to the widest.
constexpr double growth = 0.5;
constexpr double widest = 12 * std::numbers::pi / 180;

// Points of P interfere from size to size like exp(2i x), ripple repeats with its period: levels
// finer than this (in x) bring little, and are taken for tighter tolerances only.
constexpr double finest_spacing = 0.2;
constexpr double default_tolerance = 1e-2;

// Sizes more than 0.85 ripple periods apart may all meet the same resonances, and two such halves
// agree by that: they are believed only this far.
constexpr double coarse_share = 0.3;
constexpr int first_resolved_level = 2;
constexpr double resolved_spacing = 0.8;  // in x, without ripple: exp(2i x) remains

// Edges from 0 to pi/2, to be mirrored.
std::vector<double> graded_half(double narrowest) {
    std::vector<double> edges = {0};
    const double end = 0.5 * std::numbers::pi;
    while (edges.back() < end) {
        const double width = std::clamp(growth * edges.back(), std::min(narrowest, widest), widest);
        const double next = edges.back() + width;
        edges.push_back(next > end - 0.5 * width ? end : next);
    }
    return edges;
}

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
    if (distribution.kind != SizeDistributionKind::mono) {
        const double width = wave_number_per_um * (range.largest_um - range.smallest_um);
        const bool damped =
            relative_index.imag() * wave_number_per_um * effective_radius_of(distribution) > 1;
        first_count_ = damped ? smooth_first_count
                              : std::max(smooth_first_count,
                                         coarsest_even_count(relative_index.real(), width));
        const double finer =
            std::min(1.0, std::pow(options.size_tolerance / default_tolerance, 1 / 1.5));
        const double most = std::clamp(width / (finest_spacing * finer), 512.0, double(node_limit));
        resolved_level_ = first_resolved_level;
        if (damped) {
            const double levels = std::log2(width / (resolved_spacing * first_count_));
            resolved_level_ = std::max(0, static_cast<int>(std::ceil(levels)));
        }
        while (first_count_ << (last_level_ + 1) <= most) ++last_level_;
    }
    start_panels();
    while (!active_.empty()) {
        std::vector<Panel> panels = take_lowest();
        std::vector<double> angles_deg;
        for (const Panel& panel : panels) {
            for (const double theta : PhaseTable::nodes_of(panel.lower, panel.upper)) {
                angles_deg.push_back(std::clamp(theta * 180 / std::numbers::pi, 0.0, 180.0));
            }
        }
        const AngularFunctionsOf<float> angular(
            angles_deg, number_of_terms(wave_number_per_um * range.largest_um), run_);
        const Halves halves = sum_level(panels.front().level + 1, angular);
        for (std::size_t p = 0; p < panels.size(); ++p) {
            add_level(
                panels[p],
                halves.intensity.middleRows(static_cast<Eigen::Index>(p) * PhaseTable::panel_nodes,
                                            PhaseTable::panel_nodes),
                halves);
            judge(panels[p]);
            sort_in(std::move(panels[p]));
        }
    }
}

void PhaseTabulation::start_panels() {
    const std::vector<double> half = graded_half(narrowest_);
    const auto add = [this](double lower, double upper) {
        Panel panel;
        panel.lower = lower;
        panel.upper = upper;
        active_.push_back(std::move(panel));
    };
    for (std::size_t i = 0; i + 1 < half.size(); ++i) add(half[i], half[i + 1]);
    for (std::size_t i = half.size() - 1; i > 0; --i) {
        add(std::numbers::pi - half[i], std::numbers::pi - half[i - 1]);
    }
}

// Panels that share the next level of sizes.
std::vector<PhaseTabulation::Panel> PhaseTabulation::take_lowest() {
    int level = active_.front().level;
    for (const Panel& panel : active_) level = std::min(level, panel.level);
    std::vector<Panel> lowest, others;
    for (Panel& panel : active_) {
        (panel.level == level ? lowest : others).push_back(std::move(panel));
    }
    active_ = std::move(others);
    return lowest;
}

PhaseTabulation::Halves PhaseTabulation::sum_level(int level,
                                                   const AngularFunctionsOf<float>& angular) const {
    SizeNodes nodes{{range_.largest_um}, {1.0}};
    if (distribution_.kind != SizeDistributionKind::mono) {
        nodes =
            nested_size_nodes(distribution_, range_, first_count_, level, SizeSpacing::geometric);
    }
    const WeightedSizes sizes(nodes, wave_number_per_um_);
    const SizeChunks chunks(static_cast<int>(sizes.parameters.size()), largest_chunk_count,
                            least_chunk_size);
    std::vector<Halves> parts(chunks.count());
    run_(chunks.count(), [&](int job) {
        const int chunk = chunks.count() - 1 - job;  // large spheres first
        Halves& part = parts[chunk];
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
    Halves total = std::move(parts[0]);
    for (int chunk = 1; chunk < chunks.count(); ++chunk) {
        total.intensity += parts[chunk].intensity;
        for (int half : {0, 1}) total.scattered[half] += parts[chunk].scattered[half];
    }
    return total;
}

// Two halves that err independently: of the first level the spheres at even and at odd places, then
// all levels before and the new one.
void PhaseTabulation::add_level(Panel& panel, const Eigen::MatrixXd& intensity,
                                const Halves& level) const {
    if (++panel.level == 0) {
        panel.halves = intensity;
        for (int half : {0, 1}) panel.scattered[half] = level.scattered[half];
        return;
    }
    Eigen::MatrixXd halves(intensity.rows(), 2);
    halves.col(0) = 0.5 * panel.halves.rowwise().sum();
    halves.col(1) = 0.5 * intensity.rowwise().sum();
    panel.halves = std::move(halves);
    panel.scattered[0] = 0.5 * (panel.scattered[0] + panel.scattered[1]);
    panel.scattered[1] = 0.5 * (level.scattered[0] + level.scattered[1]);
}

void PhaseTabulation::judge(Panel& panel) const {
    const Eigen::VectorXd values =
        panel.halves.rowwise().sum() / (panel.scattered[0] + panel.scattered[1]);
    const double largest = values.maxCoeff();
    panel.light = 0.5 * largest * (std::cos(panel.lower) - std::cos(panel.upper));
    panel.noise = 0;
    if (panel.scattered[1] > 0) {
        // The mean of two halves errs by half their difference; rms over the panel.
        const Eigen::VectorXd difference =
            panel.halves.col(0) / panel.scattered[0] - panel.halves.col(1) / panel.scattered[1];
        panel.noise =
            0.5 * difference.norm() / (std::sqrt(double(PhaseTable::panel_nodes)) * largest);
    }
    if (options_.scattering_efficiency > 0) {
        const double sampled = panel.scattered[0] + panel.scattered[1];
        panel.noise = std::max(panel.noise, std::abs(sampled / options_.scattering_efficiency - 1));
    }
    const Eigen::VectorXd c = PhaseTable::coefficients_of(values);
    panel.tail =
        (std::abs(c[PhaseTable::panel_nodes - 1]) + std::abs(c[PhaseTable::panel_nodes - 2])) /
        largest;
}

// Error that a panel gives to the moments asked of the table: its nodes err independently, and
// |P_l| <= sqrt(2 / (pi l sin)) (Bernstein) damps what lies to the sides.
double PhaseTabulation::moment_share(const Panel& panel) const {
    const double sine = std::min(std::sin(panel.lower), std::sin(panel.upper));
    const double damping = 2 / (std::numbers::pi * std::max(1, options_.first_moment));
    const double legendre = damping < sine ? std::sqrt(damping / sine) : 1.0;
    return panel.noise * panel.light * legendre / std::sqrt(double(PhaseTable::panel_nodes));
}

bool PhaseTabulation::needs_more_sizes(const Panel& panel) const {
    if (panel.level >= last_level_) return false;
    const double believed = panel.level < resolved_level_ ? coarse_share : 1.0;
    return panel.noise > believed * options_.size_tolerance ||
           moment_share(panel) > believed * options_.moment_tolerance;
}

void PhaseTabulation::sort_in(Panel panel) {
    // Half a period of the fastest wave in P: eight nodes leave 1e-6 of that.
    const bool narrow = panel.upper - panel.lower <= 0.501 * narrowest_;
    // Noise alone shows as a tail of 0.8 of itself.
    if (panel.tail > std::max(options_.interpolation_tolerance, 2 * panel.noise) && !narrow) {
        Panel left, right;
        left.lower = panel.lower;
        left.upper = right.lower = 0.5 * (panel.lower + panel.upper);
        right.upper = panel.upper;
        active_.push_back(std::move(left));
        active_.push_back(std::move(right));
    } else if (needs_more_sizes(panel)) {
        active_.push_back(std::move(panel));
    } else {
        done_.push_back(std::move(panel));
    }
}

double PhaseTabulation::moment_error() const {
    double squares = 0;
    for (const Panel& panel : done_) squares += std::pow(moment_share(panel), 2);
    return std::sqrt(squares);
}

PhaseTable PhaseTabulation::table() const {
    std::vector<const Panel*> panels;
    for (const Panel& panel : done_) panels.push_back(&panel);
    std::sort(panels.begin(), panels.end(),
              [](const Panel* a, const Panel* b) { return a->lower < b->lower; });
    std::vector<double> edges = {0};
    Eigen::MatrixXd values(PhaseTable::panel_nodes, static_cast<Eigen::Index>(panels.size()));
    double interpolation_error = 0, size_error = 0;
    for (std::size_t p = 0; p < panels.size(); ++p) {
        const Panel& panel = *panels[p];
        edges.push_back(panel.upper);
        values.col(static_cast<Eigen::Index>(p)) =
            panel.halves.rowwise().sum() / (panel.scattered[0] + panel.scattered[1]);
        interpolation_error = std::max(interpolation_error, panel.tail);
        size_error = std::max(size_error, panel.noise);
    }
    return PhaseTable(std::move(edges), values, interpolation_error, size_error);
}

}  // namespace miebrdf::mie
