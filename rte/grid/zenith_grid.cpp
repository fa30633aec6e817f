#include "rte/grid/zenith_grid.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <stdexcept>

#include "rte/math/quadrature.h"

namespace miebrdf::rte {
namespace {

void require_count(int count) {
    if (!(count >= fewest_nodes && count <= most_nodes)) {
        throw std::invalid_argument(
            fmt::format("{} zenith nodes; allowed: {} to {}", count, fewest_nodes, most_nodes));
    }
}

}  // namespace

ZenithGrid make_gauss_grid(int count) {
    require_count(count);
    const auto rule = math::gauss_legendre(count, 0.0, 1.0);
    ZenithGrid grid{Eigen::VectorXd(count), Eigen::VectorXd(count)};
    for (int i = 0; i < count; ++i) {
        grid.mu[i] = rule.nodes[i];
        grid.weights[i] = rule.weights[i];
    }
    return grid;
}

ZenithGrid make_mapped_gauss_grid(int count) {
    ZenithGrid grid = make_gauss_grid(count);
    const Eigen::ArrayXd t = grid.mu.array();
    grid.weights.array() *= t * (4.0 - 3.0 * t);  // dmu / dt
    grid.mu = (t.square() * (2.0 - t)).matrix();
    return grid;
}

ZenithGrid make_paper_grid(int count) {
    require_count(count);
    const double quarter_pi = 0.25 * std::numbers::pi;
    const auto rule = math::gauss_legendre(count, -1.0, 1.0);
    ZenithGrid grid{Eigen::VectorXd(count), Eigen::VectorXd(count)};
    for (int i = 0; i < count; ++i) {
        const int k = count - 1 - i;  // the cosine descends where G ascends
        grid.mu[i] = std::cos(quarter_pi * (rule.nodes[k] + 1.0));
        grid.weights[i] =
            quarter_pi * rule.weights[k] * std::sin(quarter_pi * (rule.nodes[k] + 1.0));
    }
    grid.weights /= grid.weights.sum();  // only matters below 6 nodes
    return grid;
}

ZenithGrid make_zenith_grid(GridKind kind, int count) {
    switch (kind) {
        case GridKind::gauss:
            return make_gauss_grid(count);
        case GridKind::mapped_gauss:
            return make_mapped_gauss_grid(count);
        case GridKind::paper:
            return make_paper_grid(count);
        case GridKind::automatic:
            break;
    }
    throw std::invalid_argument(
        "the grid must be chosen before it is made: gauss, mapped_gauss, paper");
}

}  // namespace miebrdf::rte
