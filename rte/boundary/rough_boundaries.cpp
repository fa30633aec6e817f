#include "rte/boundary/rough_boundaries.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace miebrdf::rte {
namespace {

// 31 wavelengths with three numbers of nodes each.
constexpr std::size_t kMostKept = 100;

// Between these indices matrices follow a parabola, 3e-5 off at most. Closer to 1, where it would
// be 1e-4, they are followed; hosts are not found there.
constexpr double kFirstIndex = 1.2, kIndexStep = 0.01;
constexpr int kLastStep = 180;  // index 3

// Facets know nothing of the medium's nodes.
constexpr int kStreamsOfLobes = 16;

}  // namespace

std::shared_ptr<const RoughBoundary> RoughBoundaries::known(double index, const Boundary& kind,
                                                            const RefractionGrid& grid,
                                                            int orders) {
    const std::lock_guard lock(mutex_);
    const auto found = std::find_if(kept_.begin(), kept_.end(), [&](const Kept& one) {
        return one.boundary->index() == index && one.kind == kind && one.boundary->grid() == grid &&
               one.boundary->orders() >= orders;
    });
    if (found == kept_.end()) return nullptr;
    kept_.splice(kept_.begin(), kept_, found);
    return kept_.front().boundary;
}

std::shared_ptr<const RoughBoundary> RoughBoundaries::between_steps(double index, Boundary kind,
                                                                    int streams, int orders) {
    const int cell = int(std::floor((index - kFirstIndex) / (2 * kIndexStep)));
    const int first = std::clamp(2 * cell, 0, kLastStep - 2);
    kind.matrices = BoundaryMatrices::followed;
    std::array<std::shared_ptr<const RoughBoundary>, 3> neighbours;
    for (int k = 0; k < 3; ++k) {
        const double step = kFirstIndex + (first + k) * kIndexStep;
        neighbours[std::size_t(k)] = find(step, kind, RefractionGrid({step}, streams), orders);
    }
    return std::make_shared<const RoughBoundary>(index, std::move(neighbours));
}

std::shared_ptr<const RoughBoundary> RoughBoundaries::find(double index, const Boundary& kind,
                                                           const RefractionGrid& grid, int orders) {
    if (auto there = known(index, kind, grid, orders)) return there;
    // Panels of several media move with each of their indices.
    const bool is_one_medium = grid.panels().size() == 2;
    const bool is_interpolated =
        kind.matrices == BoundaryMatrices::interpolated && is_one_medium && index >= kFirstIndex;
    auto made = is_interpolated
                    ? between_steps(index, kind, int(grid.size()), orders)
                    : std::make_shared<const RoughBoundary>(
                          index, RoughSurface{kind.roughness, kind.distribution}, grid, orders);
    const std::lock_guard lock(mutex_);
    kept_.push_front({kind, made});
    if (kept_.size() > kMostKept) kept_.pop_back();
    return made;
}

std::shared_ptr<const RoughBoundary> RoughBoundaries::of_lobes(double index, const Boundary& kind) {
    return find(index, kind, RefractionGrid({index}, kStreamsOfLobes), 1);
}

Eigen::VectorXd RoughBoundaries::outer_lobe_scale(double index, const Boundary& kind,
                                                  const Eigen::VectorXd& mu_air) {
    const auto facets = of_lobes(index, kind);
    std::shared_ptr<const OuterLobeScale> scale;
    {
        const std::lock_guard lock(mutex_);
        const auto found = std::find_if(kept_.begin(), kept_.end(),
                                        [&](const Kept& one) { return one.boundary == facets; });
        if (found != kept_.end() && found->lobe_scale == nullptr)
            found->lobe_scale = std::make_shared<const OuterLobeScale>(facets);
        scale = found != kept_.end() ? found->lobe_scale
                                     : std::make_shared<const OuterLobeScale>(facets);
    }
    return scale->at(mu_air);
}

Eigen::VectorXd RoughBoundaries::facet_compensation(double index, const Boundary& kind,
                                                    const Eigen::VectorXd& mu_air) {
    return of_lobes(index, kind)->from_air(mu_air).compensation;
}

}  // namespace miebrdf::rte
