#include "rte/grid/directions.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include <miebrdf/error.h>
#include "rte/math/quadrature.h"

namespace miebrdf::rte {
namespace {

// The number k of samples that integrate l_j times Y_l: k = (n + .8 l) / 2 and a margin. In the
// angle whose cosine is 2t - 1, Y_l has .8 l / pi waves per unit (mapped nodes; .71 with plain
// ones), the polynomial through n nodes has n / pi, and k Gauss nodes integrate 2k / pi. (With 3
// k/4 samples 1e-6 is left at n = 24 and 192 degrees.)
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

void require_count(int count) {
    if (!(count >= kFewestNodes && count <= kMostNodes)) {
        throw UsageError("streams", count, fmt::format("{} to {}", kFewestNodes, kMostNodes));
    }
}

bool all_at_zenith(const RequestedDirections& requested, const std::vector<int>& indices) {
    return std::all_of(indices.begin(), indices.end(),
                       [&](int index) { return requested.mu[index] == 1.0; });
}

}  // namespace

double GridPanel::cosine(double t) const {
    const double shape = map == Map::straight  ? t
                         : map == Map::squared ? t * t * (2.0 - t)
                                               : std::sin(0.5 * std::numbers::pi * t);
    const double c = widest * shape;
    return offset == 0.0 && factor == 1.0 ? c : std::sqrt(offset + factor * c * c);
}

double GridPanel::slope(double t) const {
    const double quarter = 0.5 * std::numbers::pi;
    const double dc = widest * (map == Map::straight  ? 1.0
                                : map == Map::squared ? t * (4.0 - 3.0 * t)
                                                      : quarter * std::cos(quarter * t));
    if (offset == 0.0 && factor == 1.0) return dc;
    const double c = GridPanel{.map = map, .widest = widest}.cosine(t);
    return factor * c * dc / cosine(t);  // mu dmu = factor c dc
}

bool GridPanel::ends_at_zenith() const {
    constexpr double rounding = 1e-12;
    return map != Map::circular && std::abs(cosine(1.0) - 1.0) <= rounding;
}

ZenithGrid make_panel_grid(std::vector<GridPanel> panels) {
    ZenithGrid grid;
    Eigen::Index first = 0;
    for (const GridPanel& panel : panels) first += panel.count;
    grid.mu.resize(first);
    grid.weights.resize(first);
    first = 0;
    for (const GridPanel& panel : panels) {
        const auto rule = math::gauss_legendre(int(panel.count), 0.0, 1.0);
        for (std::size_t k = 0; k < rule.nodes.size(); ++k, ++first) {
            grid.mu[first] = panel.cosine(rule.nodes[k]);
            grid.weights[first] = rule.weights[k] * panel.slope(rule.nodes[k]);
        }
    }
    grid.panels = std::move(panels);
    return grid;
}

std::vector<double> resolved_waves(const ZenithGrid& grid, int count) {
    // Distance of t from the ends of a panel, where the formula below gives a distance of nodes of
    // 0.
    constexpr double inside = 1e-4;
    std::vector<double> waves;
    for (int k = 0; k < count && !grid.panels.empty(); ++k) {
        const double angle = 0.5 * std::numbers::pi * k / (count - 1);
        const double mu = std::cos(angle);
        const auto panel =
            std::min_element(grid.panels.begin(), grid.panels.end(), [mu](auto& a, auto& b) {
                return std::max({a.cosine(0.0) - mu, mu - a.cosine(1.0), 0.0}) <
                       std::max({b.cosine(0.0) - mu, mu - b.cosine(1.0), 0.0});
            });
        double low = inside, high = 1.0 - inside;
        for (int step = 0; step < 40; ++step) {
            const double middle = 0.5 * (low + high);
            (panel->cosine(middle) < mu ? low : high) = middle;
        }
        // Gauss nodes are pi (t (1 - t))^(1/2) / n apart.
        const double t = 0.5 * (low + high);
        const double sine = std::sqrt(1.0 - std::pow(panel->cosine(t), 2));
        waves.push_back(double(panel->count) * sine / (panel->slope(t) * std::sqrt(t * (1.0 - t))));
    }
    return waves;
}

ZenithGrid make_gauss_grid(int count) {
    require_count(count);
    return make_panel_grid({{.count = count}});
}

ZenithGrid make_mapped_gauss_grid(int count) {
    require_count(count);
    return make_panel_grid({{.count = count, .map = GridPanel::Map::squared}});
}

ZenithGrid make_paper_grid(int count) {
    require_count(count);
    // With G = 2 t' - 1 and t = 1 - t': pi/4 G + pi/4 = pi/2 - pi t / 2.
    ZenithGrid grid = make_panel_grid({{.count = count, .map = GridPanel::Map::circular}});
    grid.weights /= grid.weights.sum();  // changes weights below 6 nodes alone
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
    throw UsageError("grid", std::string("automatic"), "gauss, mapped_gauss, paper");
}

bool points_suffice(const ZenithGrid& grid, int degrees) {
    if (degrees == 1 || grid.panels.empty()) return true;
    const GridPanel& panel = grid.panels.front();
    if (grid.panels.size() > 1 || panel.offset > 0.0 || panel.map == GridPanel::Map::circular)
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

RequestedDirections collect(const std::vector<double>& mu_in, const std::vector<double>& mu_out) {
    std::vector<double> cosines = mu_in;
    cosines.insert(cosines.end(), mu_out.begin(), mu_out.end());
    std::sort(cosines.begin(), cosines.end());
    cosines.erase(std::unique(cosines.begin(), cosines.end()), cosines.end());
    const auto position = [&](double mu) {
        return int(std::lower_bound(cosines.begin(), cosines.end(), mu) - cosines.begin());
    };
    RequestedDirections requested;
    requested.mu = Eigen::Map<const Eigen::VectorXd>(cosines.data(), Eigen::Index(cosines.size()));
    for (const double mu : mu_in) requested.in.push_back(position(mu));
    for (const double mu : mu_out) requested.out.push_back(position(mu));
    return requested;
}

RequestedDirections with_cosines_beside(RequestedDirections requested) {
    const Eigen::Index own =
        requested.beside.empty() ? requested.mu.size() : Eigen::Index(requested.beside.size());
    requested.beside.assign(std::size_t(own), -1);
    std::vector<double> cosines(requested.mu.data(), requested.mu.data() + own);
    for (const int out : requested.out) {
        const bool is_incident =
            std::find(requested.in.begin(), requested.in.end(), out) != requested.in.end();
        if (!is_incident || requested.beside[std::size_t(out)] >= 0) continue;
        requested.beside[std::size_t(out)] = int(cosines.size());
        cosines.push_back(requested.mu[out] * (1.0 - kBeside));
        cosines.push_back(requested.mu[out] * (1.0 - 2.0 * kBeside));
    }
    requested.mu = Eigen::Map<const Eigen::VectorXd>(cosines.data(), Eigen::Index(cosines.size()));
    return requested;
}

bool only_fourier_order_zero(const RequestedDirections& requested) {
    return all_at_zenith(requested, requested.in) || all_at_zenith(requested, requested.out);
}

bool fourier_order_vanishes(int fourier_order, std::span<const double> azimuth_deg) {
    return std::all_of(azimuth_deg.begin(), azimuth_deg.end(), [fourier_order](double azimuth) {
        return std::abs(std::remainder(fourier_order * azimuth, 180.0)) == 90.0;
    });
}

}  // namespace miebrdf::rte
