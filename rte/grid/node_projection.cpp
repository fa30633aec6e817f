#include "rte/grid/directions.h"

#include <algorithm>
#include <cmath>

#include "rte/math/quadrature.h"

namespace miebrdf::rte {
namespace {

// Samples that integrate l_j times Y_l. In the angle whose cosine is 2t - 1, Y_l has .8 l / pi
// waves per unit (mapped nodes; .71 with plain ones), the polynomial through n nodes n / pi, and k
// Gauss nodes integrate 2k / pi: k = (n + .8 l) / 2 and a margin. (With three quarters of it 1e-6
// is left at n = 24 and 192 degrees.)
Eigen::Index fine_count(Eigen::Index count, int degrees) {
    constexpr double margin = 6.0;
    return Eigen::Index(
        std::ceil(0.5 * double(count) + 0.4 * degrees + margin + 2.0 * std::cbrt(double(degrees))));
}

// l_j(t) = (b_j / (t - t_j)) / sum_i (b_i / (t - t_i)), b_j = (-1)^j (t_j (1 - t_j) w_j)^(1/2).
Eigen::RowVectorXd cardinal_functions(const math::Quadrature& nodes, double t) {
    const auto count = Eigen::Index(nodes.nodes.size());
    Eigen::RowVectorXd values(count);
    for (Eigen::Index j = 0; j < count; ++j) {
        const double node = nodes.nodes[std::size_t(j)];
        if (t == node) return Eigen::RowVectorXd::Unit(count, j);
        const double strength =
            std::sqrt(node * (1.0 - node) * nodes.weights[std::size_t(j)]) * (j % 2 == 0 ? 1 : -1);
        values[j] = strength / (t - node);
    }
    return values / values.sum();
}

}  // namespace

bool points_suffice(const ZenithGrid& grid, int degrees) {
    if (degrees == 1 || grid.panels.empty()) return true;
    const GridPanel& panel = grid.panels.front();
    if (grid.panels.size() > 1 || panel.beyond > 0.0 || panel.map == GridPanel::Map::circular)
        return false;
    const Eigen::Index power = panel.map == GridPanel::Map::squared ? 3 : 1;  // of t in mu
    return 2 * (degrees - 1) * power + power - 1 <= 2 * panel.count - 1;
}

NodeProjection project_on_nodes(const ZenithGrid& grid, int degrees) {
    NodeProjection projection{grid.panels, degrees, {}, {}, {}};
    Eigen::Index samples_in_all = 0;
    for (const GridPanel& panel : grid.panels) samples_in_all += fine_count(panel.count, degrees);
    projection.fine.mu.resize(samples_in_all);
    projection.fine.weights.resize(samples_in_all);
    projection.even.setZero(grid.size(), samples_in_all);
    projection.odd.setZero(grid.size(), samples_in_all);
    Eigen::Index node = 0;
    Eigen::Index sample = 0;
    for (const GridPanel& panel : grid.panels) {
        const auto nodes = math::gauss_legendre(int(panel.count), 0.0, 1.0);
        const auto fine = math::gauss_legendre(int(fine_count(panel.count, degrees)), 0.0, 1.0);
        const bool has_zenith = panel.ends_at_zenith();
        for (std::size_t k = 0; k < fine.nodes.size(); ++k, ++sample) {
            const double t = fine.nodes[k];
            const double weight = fine.weights[k] * panel.slope(t);
            projection.fine.mu[sample] = panel.cosine(t);
            projection.fine.weights[sample] = weight;
            const Eigen::RowVectorXd cardinal = cardinal_functions(nodes, t);
            for (Eigen::Index j = 0; j < panel.count; ++j) {
                const double value = weight * cardinal[j] / grid.weights[node + j];
                const double root =
                    has_zenith ? std::sqrt((1.0 - t) / (1.0 - nodes.nodes[std::size_t(j)])) : 1.0;
                projection.even(node + j, sample) = value;
                projection.odd(node + j, sample) = root * value;
            }
        }
        node += panel.count;
    }
    return projection;
}

const NodeProjection& NodeProjections::find(const ZenithGrid& grid, int degrees) {
    const auto known = std::find_if(known_.begin(), known_.end(), [&](const NodeProjection& one) {
        return one.degrees == degrees && one.panels == grid.panels;
    });
    if (known != known_.end()) return *known;
    constexpr std::size_t most = 12;
    if (known_.size() == most) known_.erase(known_.begin());
    return known_.emplace_back(project_on_nodes(grid, degrees));
}

}  // namespace miebrdf::rte
