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
    return beyond == 0.0 && share == 1.0 ? c : std::sqrt(beyond + share * c * c);
}

double GridPanel::slope(double t) const {
    const double quarter = 0.5 * std::numbers::pi;
    const double dc = widest * (map == Map::straight  ? 1.0
                                : map == Map::squared ? t * (4.0 - 3.0 * t)
                                                      : quarter * std::cos(quarter * t));
    if (beyond == 0.0 && share == 1.0) return dc;
    const GridPanel own{.map = map, .widest = widest};
    return share * own.cosine(t) * dc / cosine(t);  // mu dmu = share c dc
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
    // t stays this far from the ends of a panel, where the formula gives a distance of 0.
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
