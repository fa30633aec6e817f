#include "rte/stack/scaled_stack.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "rte/boundary/rough_boundaries.h"
#include "rte/first_order/glory_correction.h"
#include "rte/stack/hidden_layers.h"

namespace miebrdf::rte {

namespace {

// Sets the refractive indices, from the top down. A medium whose index differs from that above by
// less than kLeastIndexStep takes the index above, so that no boundary lies between.
void find_indices(const Stack& stack, ScaledStack& scaled) {
    const bool is_on_coat = stack.base_kind != BaseKind::half_space && !stack.coats.empty();
    const double lowest = is_on_coat ? stack.coats.front().index : stack.base_index;
    scaled.mirror_index = stack.mirror_index;
    scaled.boundary = stack.boundary;
    scaled.ground_index = lowest;
    if (!stack.boundary) {
        // The reflectance of a mirror depends on its index relative to that of the medium above.
        scaled.mirror_index /= lowest;
        scaled.ground_index = scaled.top_index = 1.0;
        for (ScaledMedium& medium : scaled.media) medium.index = 1.0;
        return;
    }
    double above = 1.0;
    const auto snap = [&above](double& index) {
        if (std::abs(index - above) < kLeastIndexStep * above) index = above;
        above = index;
    };
    for (std::size_t i = scaled.media.size(); i-- > 0;) snap(scaled.media[i].index);
    if (!scaled.media.empty()) scaled.ground_index = scaled.media.front().index;
    snap(scaled.ground_index);
    scaled.top_index = scaled.media.empty() ? scaled.ground_index : scaled.media.back().index;
    if (scaled.top_index == 1.0) scaled.boundary.reset();
}

// Removes layers of depth 0 that have the index of a neighbour; others stay, because their two
// surfaces reflect. (The ground has the index of the lowest layer.)
void remove_layers_without_surfaces(ScaledStack& scaled) {
    std::vector<ScaledMedium>& media = scaled.media;
    for (std::size_t i = media.size(); i-- > 0;) {
        if (media[i].scaled_optical_depth > 0.0) continue;
        const double above = i + 1 < media.size() ? media[i + 1].index : 1.0;
        const double below = i > 0 ? media[i - 1].index : scaled.ground_index;
        if (media[i].index == above || media[i].index == below)
            media.erase(media.begin() + std::ptrdiff_t(i));
    }
    scaled.top_index = media.empty() ? scaled.ground_index : media.back().index;
}

std::vector<double> indices_of(const ScaledStack& stack) {
    std::vector<double> indices;
    for (const ScaledMedium& medium : stack.media) indices.push_back(medium.index);
    if (indices.empty() || stack.ground_index != indices.front())
        indices.push_back(stack.ground_index);
    return indices;
}

}  // namespace

ScaledStack scale_stack(const Stack& stack, int moments, bool delta_m) {
    ScaledStack scaled;
    scale_stack(stack, moments, delta_m, scaled);
    return scaled;
}

BaseKind lowest_kind(const Stack& stack) {
    const bool is_hidden = std::any_of(stack.coats.begin(), stack.coats.end(), [](const Coat& c) {
        return c.optical_depth != 0.0 && is_bottomless(c.optical_depth);
    });
    return is_hidden ? BaseKind::half_space : stack.base_kind;
}

void scale_stack(const Stack& stack, int moments, bool delta_m, ScaledStack& scaled) {
    scaled.transmits = false;
    scaled.brightness = 0.0;
    scaled.moments = moments;
    scaled.base = stack.base_kind;
    scaled.ground_albedo = stack.ground_albedo;
    std::size_t count = 0;
    const auto add = [&](const Optics& optics, double optical_depth, double index) {
        if (count == scaled.media.size()) scaled.media.emplace_back();
        ScaledMedium& medium = scaled.media[count++];
        medium.exact = optics;
        scale_optics(optics, moments, delta_m, medium.scaled);
        medium.scaled_optical_depth = bounded_depth(optical_depth * medium.scaled.depth_factor);
        medium.narrow = {};
        medium.unresolved_shares.clear();
        medium.index = index;
    };
    if (stack.base_kind == BaseKind::half_space) {
        add(stack.base, std::numeric_limits<double>::infinity(), stack.base_index);
    }
    for (const Coat& coat : stack.coats) {
        if (coat.optical_depth == 0.0 && !stack.boundary) continue;
        if (is_bottomless(coat.optical_depth)) {
            count = 0;
            scaled.base = BaseKind::half_space;
        }
        add(coat.optics, coat.optical_depth, coat.index);
    }
    scaled.media.resize(count);
    scaled.ground.reset();
    if (scaled.base == BaseKind::brdf) scaled.ground = stack.ground;
    find_indices(stack, scaled);
    if (stack.boundary) remove_layers_without_surfaces(scaled);
    if (scaled.boundary && scaled.boundary->is_rough() && scaled.rough_boundaries == nullptr)
        scaled.rough_boundaries = std::make_shared<RoughBoundaries>();
}

StackGrids::StackGrids(const ScaledStack& stack, GridKind kind, int count)
    : kind_(kind), count_(count), indices_{1.0} {
    if (!stack.refracts()) {
        grids_.push_back(make_zenith_grid(kind, count));
        return;
    }
    std::vector<double> scattering = indices_of(stack);
    // A rough boundary sends light from every panel into every other.
    constexpr int least_rough = 2;
    const bool is_rough = stack.boundary && stack.boundary->is_rough();
    refraction_.emplace(scattering, count_, is_rough ? least_rough : 1);
    scattering_ = scattering;
    scattering.push_back(1.0);
    std::sort(scattering.begin(), scattering.end());
    scattering.erase(std::unique(scattering.begin(), scattering.end()), scattering.end());
    indices_ = std::move(scattering);
    for (const double index : indices_) grids_.push_back(refraction_->in_medium(index));
}

bool StackGrids::fit(const ScaledStack& stack, GridKind kind, int count) const {
    if (kind != kind_ || count != count_) return false;
    if (!stack.refracts()) return scattering_.empty();
    if (stack.boundary && stack.boundary->is_rough()) return false;
    return scattering_ == indices_of(stack);
}

const ZenithGrid& StackGrids::of(double index) const {
    const auto at = std::find(indices_.begin(), indices_.end(), index);
    return grids_[std::size_t(at - indices_.begin())];
}

void split_by_resolution(ScaledStack& stack, const StackGrids& grids) {
    for (ScaledMedium& medium : stack.media) {
        medium.narrow = split_forward_peak(medium.exact.chi, 1, medium.scaled.first_cutoff);
        medium.unresolved_shares.clear();
        if (medium.narrow.structure.empty()) continue;
        medium.unresolved_shares = unresolved_shares(
            resolved_waves(grids.of(medium.index), kResolvedAngles), int(medium.scaled.chi.size()));
    }
}

}  // namespace miebrdf::rte
