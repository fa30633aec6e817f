#include "rte/boundary/rough_boundary.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace miebrdf::rte {
namespace {

/// t of t^2 (2 - t) = c: with t = (2 + 4 cos(angle)) / 3 a cubic in cos(angle), whose root in
/// [0, 1] belongs to the second third of the circle.
double unmapped(double c) {
    const double third = 2.0 * std::asin(std::sqrt(27.0 / 32.0 * c)) / 3.0;
    return 2.0 / 3.0 * (1.0 + 2.0 * std::cos(2.0 * std::numbers::pi / 3.0 - third));
}

double sine_of(double mu) { return std::sqrt(std::max(0.0, (1.0 - mu) * (1.0 + mu))); }

double panel_variable(const RefractionPanel& panel, double cosine) {
    const double c = std::clamp(cosine / panel.widest, 0.0, 1.0);
    return panel.mapped ? unmapped(c) : c;
}

}  // namespace

PanelFunctions::PanelFunctions(const RefractionGrid& grid, double index)
    : grid_(grid), index_(index), q_(grid.size()), scale_(grid.size()) {
    const Eigen::VectorXd mu = grid.in_medium(index).mu;
    for (Eigen::Index p = 0; p < q_.size(); ++p) q_[p] = index * sine_of(mu[p]);
    for (const RefractionPanel& panel : grid.panels()) {
        for (Eigen::Index p = panel.first; p < panel.first + panel.count; ++p) {
            double product = 1.0;
            for (Eigen::Index k = panel.first; k < panel.first + panel.count; ++k) {
                if (k != p) product *= grid.t()[p] - grid.t()[k];
            }
            scale_[p] = 1.0 / product;
        }
    }
}

PanelFunctions::Position PanelFunctions::inside_at(double mu) const {
    const std::vector<RefractionPanel>& panels = grid_.panels();
    for (std::size_t k = panels.size(); k-- > 1;) {
        // n^2 (1 - mu^2) = high^2 (1 - c^2): c is the cosine where this panel ends.
        const double high = panels[k].high;
        const double c2 = index_ * index_ * mu * mu - (index_ - high) * (index_ + high);
        if (c2 > 0.0) return {k, panel_variable(panels[k], std::sqrt(c2) / high)};
    }
    return {0, panel_variable(panels.front(), mu)};
}

PanelFunctions::Position PanelFunctions::in_air_at(double mu_air) const {
    return {grid_.panels().size() - 1, panel_variable(grid_.panels().back(), mu_air)};
}

// Products from the left times products from the right: no division, also at a node.
void PanelFunctions::evaluate(const Position& at, double* values) const {
    const RefractionPanel& panel = grid_.panels()[at.panel];
    double product = 1.0;
    for (Eigen::Index k = 0; k < panel.count; ++k) {
        values[k] = product * scale_[panel.first + k];
        product *= at.t - grid_.t()[panel.first + k];
    }
    product = 1.0;
    for (Eigen::Index k = panel.count; k-- > 0;) {
        values[k] *= product;
        product *= at.t - grid_.t()[panel.first + k];
    }
}

template <typename Locate>
Eigen::MatrixXd PanelFunctions::collect(const ScatteredRays& rays, int orders, double index,
                                        const Locate& locate) const {
    std::vector<std::vector<std::pair<std::size_t, Position>>> by_panel(grid_.panels().size());
    for (std::size_t k = 0; k < rays.energy.size(); ++k) {
        const Position at = locate(rays.mu[k]);
        by_panel[at.panel].emplace_back(k, at);
    }
    Eigen::MatrixXd energy = Eigen::MatrixXd::Zero(grid_.size(), orders);
    for (std::size_t panel = 0; panel < by_panel.size(); ++panel) {
        const RefractionPanel& nodes = grid_.panels()[panel];
        energy.middleRows(nodes.first, nodes.count) =
            collect(rays, by_panel[panel], nodes.count, orders, index);
    }
    for (int m = 1; m < orders; m += 2) energy.col(m).array() /= q_.array();
    return energy;
}

/// Of the rays in one panel: nodes x orders, odd orders times q.
Eigen::MatrixXd PanelFunctions::collect(const ScatteredRays& rays,
                                        const std::vector<std::pair<std::size_t, Position>>& some,
                                        Eigen::Index nodes, int orders, double index) const {
    const auto count = Eigen::Index(some.size());
    Eigen::MatrixXd functions(nodes, count);
    Eigen::MatrixXd azimuths(orders, count);  // energy cos(order azimuth)
    for (Eigen::Index ray = 0; ray < count; ++ray) {
        const auto& [k, at] = some[std::size_t(ray)];
        evaluate(at, &functions(0, ray));
        const double cosine = std::clamp(rays.cos_azimuth[k], -1.0, 1.0);
        azimuths(0, ray) = rays.energy[k];
        if (orders > 1) azimuths(1, ray) = rays.energy[k] * cosine;
        for (int m = 2; m < orders; ++m) {
            azimuths(m, ray) = 2.0 * cosine * azimuths(m - 1, ray) - azimuths(m - 2, ray);
        }
        const double q = index * sine_of(rays.mu[k]);
        for (int m = 1; m < orders; m += 2) azimuths(m, ray) *= q;
    }
    return functions * azimuths.transpose();
}

Eigen::VectorXd PanelFunctions::inside_values(double mu, int order) const {
    Eigen::VectorXd values = Eigen::VectorXd::Zero(grid_.size());
    const Position at = inside_at(mu);
    evaluate(at, &values[grid_.panels()[at.panel].first]);
    if (order % 2 == 1) values.array() *= index_ * sine_of(mu) / q_.array();
    return values;
}

Eigen::VectorXd PanelFunctions::in_air_values(double mu_air, int order) const {
    Eigen::VectorXd values(grid_.nodes_below(1.0));
    evaluate(in_air_at(mu_air), values.data());
    if (order % 2 == 1) values.array() *= sine_of(mu_air) / q_.tail(values.size()).array();
    return values;
}

Eigen::MatrixXd PanelFunctions::inside(const ScatteredRays& rays, int orders) const {
    return collect(rays, orders, index_, [this](double mu) { return inside_at(mu); });
}

Eigen::MatrixXd PanelFunctions::in_air(const ScatteredRays& rays, int orders) const {
    return collect(rays, orders, 1.0, [this](double mu) { return in_air_at(mu); })
        .bottomRows(grid_.nodes_below(1.0));
}

void drop_unresolved_orders(Eigen::MatrixXd& energy) {
    // A lobe's own orders fall, but for dips that are shallower.
    constexpr double noise_rises_by = 4.0;
    const Eigen::RowVectorXd size = energy.cwiseAbs().colwise().sum();
    const Eigen::Index orders = size.size();
    Eigen::RowVectorXd envelope = size;  // even and odd orders have functions of their own
    for (Eigen::Index m = 1; m < orders; ++m) envelope[m] = std::max(size[m], size[m - 1]);
    Eigen::Index last;
    const double least = envelope.minCoeff(&last);
    const Eigen::Index beyond = orders - last - 1;
    if (beyond > 0 && envelope.tail(beyond).maxCoeff() >= noise_rises_by * least)
        energy.rightCols(beyond).setZero();
}

}  // namespace miebrdf::rte
