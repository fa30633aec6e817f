#include "mie/ensemble/ray_phase.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <vector>

#include "mie/ensemble/size_sums.h"
#include "mie/sphere/lane_math.h"

namespace miebrdf::mie {

RaySizeRule RayGroup::sizes_at(int level) const {
    if (level == 0) return {{kLaneCount, kLaneCount}, -1};
    // The even rule of n + 1 sizes has n: the one at the end has no weight.
    if (is_closed()) return {{17, 25}, level - 1};
    return {{25, 33}, level - 1};
}

std::vector<RayGroup> ray_groups(bool exact) {
    std::vector<RayGroup> groups = {{0, 0}, {1, 1}, {2, 2}, {3, 3}, {4, 4}};
    if (exact) {
        groups.insert(groups.end(), {{5, 6}, {7, 16}, {17, 0}});
    } else {
        groups.insert(groups.end(), {{5, 6}, {7, 0, 4}});
    }
    return groups;
}

RayWindow::RayWindow(double index, double smallest_x, double largest_x)
    : smallest_(smallest_x), largest_(largest_x) {
    constexpr double kNarrowest = 15, kPhases = 8, kWidest = 0.45;
    width_ =
        std::min(std::max(kNarrowest, kPhases / (index - 1)), kWidest * (largest_x - smallest_x));
}

double RayWindow::at(double x) const {
    const auto rise = [&](double distance) {
        const double u = std::clamp(distance / width_, 0.0, 1.0);
        return std::min(1.0, u * u * u * u * (35 + u * (-84 + u * (70 - 20 * u))));
    };
    return rise(x - smallest_) * rise(largest_ - x);
}

RaySizes::RaySizes(const Ensemble& ensemble, const std::optional<RayWindow>& window)
    : ensemble_(ensemble), window_(window), density_(area_density(ensemble.sizes)) {
    const RadiusRange& range = ensemble.range;
    const double wave_number_per_um = ensemble.wave_number_per_um;
    // Pieces over each of which the density and the window are smooth.
    static const math::Quadrature piece = math::gauss_legendre(64, 0, 1);
    const double width_um = window ? window->width() / wave_number_per_um : 0;
    const double lower = range.smallest_um + width_um, upper = range.largest_um - width_um;
    std::vector<double> edges = {std::log(lower), 0.5 * std::log(lower * upper), std::log(upper)};
    if (window) {
        edges.insert(edges.begin(), std::log(range.smallest_um));
        edges.push_back(std::log(range.largest_um));
    }
    for (std::size_t e = 0; e + 1 < edges.size(); ++e) {
        const double length = edges[e + 1] - edges[e];
        for (std::size_t i = 0; i < piece.nodes.size(); ++i) {
            const double log_radius = edges[e] + length * piece.nodes[i];
            const double radius = std::exp(log_radius);
            area_.nodes.push_back(log_radius);
            area_.weights.push_back(length * piece.weights[i] * wave_number_per_um * radius *
                                    area_at(wave_number_per_um * radius));
        }
    }
    whole_area_ = std::accumulate(area_.weights.begin(), area_.weights.end(), 0.0);
}

double RaySizes::area_at(double x) const {
    const double per_x =
        density_->at(x / ensemble_.wave_number_per_um) / ensemble_.wave_number_per_um;
    return window_ ? per_x * window_->at(x) : per_x;
}

WeightedSizes RaySizes::of(const RaySizeRule& rule, int sample) const {
    const int count = rule.counts[sample];
    if (rule.is_smooth()) {
        const math::Quadrature gauss = math::gauss_rule(
            area_, count, sample == 0 ? math::GaussRule::gauss : math::GaussRule::radau);
        SizeNodes nodes;
        nodes.area_share = gauss.weights;
        for (const double log_radius : gauss.nodes) nodes.radius_um.push_back(std::exp(log_radius));
        return WeightedSizes(nodes, ensemble_.wave_number_per_um);
    }
    WeightedSizes sizes(nested_size_nodes(ensemble_.sizes, ensemble_.range, count,
                                          rule.nested_level, SizeSpacing::geometric),
                        ensemble_.wave_number_per_um);
    double sampled = 0;
    for (std::size_t i = 0; i < sizes.weights.size(); ++i) {
        double& weight = sizes.weights[i];
        if (window_) weight *= window_->at(sizes.parameters[i]);
        sampled += weight * sizes.parameters[i] * sizes.parameters[i];
    }
    for (double& weight : sizes.weights) weight *= whole_area_ / sampled;
    return sizes;
}

}  // namespace miebrdf::mie
