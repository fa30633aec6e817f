#include "mie/phase_tabulation.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "mie/terms.h"

namespace miebrdf::mie {
namespace {

constexpr int sizes_per_block = 64;
constexpr int largest_chunk_count = 8;

// Widths grow by this share of the distance from the nearer end, up to the widest.
constexpr double growth = 0.35;
constexpr double widest = 6 * std::numbers::pi / 180;

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
                                 std::vector<double> size_parameters, std::vector<double> weights,
                                 double tolerance)
    : relative_index_(relative_index),
      size_parameters_(std::move(size_parameters)),
      weights_(std::move(weights)),
      tolerance_(tolerance),
      // P is a trigonometric polynomial of degree 2 x: nothing is finer than pi / x.
      narrowest_(std::numbers::pi / size_parameters_.back()) {
    const std::vector<double> half = graded_half(narrowest_);
    std::vector<Panel> panels;
    for (std::size_t i = 0; i + 1 < half.size(); ++i) {
        panels.push_back({half[i], half[i + 1], {}});
    }
    for (std::size_t i = half.size() - 1; i > 0; --i) {
        panels.push_back({std::numbers::pi - half[i], std::numbers::pi - half[i - 1], {}});
    }
    prepare(std::move(panels));
}

void PhaseTabulation::prepare(std::vector<Panel> panels) {
    active_ = std::move(panels);
    std::vector<double> angles_deg;
    for (const Panel& panel : active_) {
        for (const double theta : PhaseTable::nodes_of(panel.lower, panel.upper)) {
            angles_deg.push_back(std::clamp(theta * 180 / std::numbers::pi, 0.0, 180.0));
        }
    }
    angular_ = AngularFunctionsOf<float>(angles_deg, number_of_terms(size_parameters_.back()));
    sums_ = {};
}

int PhaseTabulation::chunk_count() const {
    const int blocks =
        (static_cast<int>(size_parameters_.size()) + sizes_per_block - 1) / sizes_per_block;
    return std::min(blocks, largest_chunk_count);
}

PhaseHalves PhaseTabulation::compute(int chunk) const {
    const int size = static_cast<int>(size_parameters_.size());
    const int blocks = (size + sizes_per_block - 1) / sizes_per_block;
    const int chunks = chunk_count();
    PhaseHalves halves;
    halves.intensity = Eigen::MatrixXd::Zero(angular_.angle_count(), 2);
    SphereBlock block;
    for (int b = chunk * blocks / chunks; b < (chunk + 1) * blocks / chunks; ++b) {
        const int first = b * sizes_per_block;
        const int count = std::min(sizes_per_block, size - first);
        compute_spheres(relative_index_, {size_parameters_.data() + first, std::size_t(count)},
                        {weights_.data() + first, std::size_t(count)}, &block);
        angular_.add_intensity(block, halves.intensity);
        // As the intensities: by the place of the sphere, which is that of the column.
        Eigen::RowVectorXd squares = Eigen::RowVectorXd::Zero(2 * block.size);
        for (int n = 1; n <= block.terms; ++n) {
            squares += (2 * n + 1) * (block.U.row(n).cwiseAbs2() + block.V.row(n).cwiseAbs2());
        }
        for (int column = 0; column < 2 * block.size; ++column) {
            halves.scattered[column % 2] += squares[column];
        }
    }
    return halves;
}

void PhaseTabulation::merge(const PhaseHalves& chunk) {
    if (sums_.intensity.size() == 0) {
        sums_ = chunk;
        return;
    }
    sums_.intensity += chunk.intensity;
    for (int half = 0; half < 2; ++half) sums_.scattered[half] += chunk.scattered[half];
}

bool PhaseTabulation::has_converged(Panel& panel, const Eigen::MatrixXd& intensity) {
    panel.values = intensity.rowwise().sum() / (sums_.scattered[0] + sums_.scattered[1]);
    const double largest = panel.values.cwiseAbs().maxCoeff();
    double noise = 0;
    if (sums_.scattered[1] > 0) {
        // Two halves err independently: their mean by half their difference, rms over the panel.
        noise =
            0.5 *
            (intensity.col(0) / sums_.scattered[0] - intensity.col(1) / sums_.scattered[1]).norm() /
            (std::sqrt(double(PhaseTable::panel_nodes)) * largest);
    }
    const Eigen::VectorXd c = PhaseTable::coefficients_of(panel.values);
    const double tail =
        (std::abs(c[PhaseTable::panel_nodes - 1]) + std::abs(c[PhaseTable::panel_nodes - 2])) /
        largest;
    const bool converged =
        tail <= std::max(tolerance_, noise) || panel.upper - panel.lower <= narrowest_ * 1.001;
    if (converged) {
        interpolation_error_ = std::max(interpolation_error_, tail);
        size_error_ = std::max(size_error_, noise);
    }
    return converged;
}

bool PhaseTabulation::finish_pass() {
    std::vector<Panel> next;
    for (std::size_t p = 0; p < active_.size(); ++p) {
        Panel& panel = active_[p];
        const Eigen::MatrixXd intensity = sums_.intensity.middleRows(
            static_cast<Eigen::Index>(p) * PhaseTable::panel_nodes, PhaseTable::panel_nodes);
        if (has_converged(panel, intensity)) {
            done_.push_back(std::move(panel));
        } else {
            const double middle = 0.5 * (panel.lower + panel.upper);
            next.push_back({panel.lower, middle, {}});
            next.push_back({middle, panel.upper, {}});
        }
    }
    if (next.empty()) return false;
    prepare(std::move(next));
    return true;
}

PhaseTable PhaseTabulation::table() const {
    std::vector<const Panel*> panels;
    for (const Panel& panel : done_) panels.push_back(&panel);
    std::sort(panels.begin(), panels.end(),
              [](const Panel* a, const Panel* b) { return a->lower < b->lower; });
    std::vector<double> edges = {0};
    Eigen::MatrixXd values(PhaseTable::panel_nodes, static_cast<Eigen::Index>(panels.size()));
    for (std::size_t p = 0; p < panels.size(); ++p) {
        edges.push_back(panels[p]->upper);
        values.col(static_cast<Eigen::Index>(p)) = panels[p]->values;
    }
    return PhaseTable(std::move(edges), values, interpolation_error_, size_error_);
}

}  // namespace miebrdf::mie
