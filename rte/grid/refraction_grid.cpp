#include "rte/grid/refraction_grid.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "rte/math/quadrature.h"

namespace miebrdf::rte {
namespace {

// The indices low < high of two media are close if high < kCloseIndices low. The panel between
// their critical angles gets half as many nodes as others, and the next panel (of smaller q) ends
// so close to grazing in both media that its nodes are mapped, too.
constexpr double kCloseIndices = 1.05;

bool are_close(double low, double high) { return high < kCloseIndices * low; }

double root_of_difference(double larger, double smaller) {
    return std::sqrt((larger - smaller) * (larger + smaller));
}

// The nodes of each panel. One or two panels have `count` nodes together. Each of three or more has
// count / 2 (count / 4 if its indices are close): light from air must not meet fewer nodes because
// there are many media, and two solutions that are compared must differ in every panel.
std::vector<int> nodes_of(const std::vector<RefractionPanel>& panels, int count, int least) {
    std::vector<int> parts;
    int sum = 0;
    for (const RefractionPanel& panel : panels) {
        parts.push_back(are_close(panel.low, panel.high) ? 1 : 2);
        sum += parts.back();
    }
    if (panels.size() == 1) return {std::max(least, count)};
    if (panels.size() == 2) {
        const int wanted = int(std::lround(double(count * parts.front()) / sum));
        const int first = std::max(least, std::min(wanted, count - 1));
        return {first, std::max(least, count - first)};
    }
    std::vector<int> counts;
    for (const int part : parts)
        counts.push_back(std::max(least, int(std::lround(double(count * part) / 4))));
    return counts;
}

}  // namespace

RefractionGrid::RefractionGrid(std::vector<double> indices, int count, int least) {
    const std::vector<double> scattering = indices;
    indices.push_back(1.0);
    std::sort(indices.begin(), indices.end());
    indices.erase(std::unique(indices.begin(), indices.end()), indices.end());
    for (std::size_t k = indices.size(); k-- > 0;) {
        RefractionPanel panel;
        panel.low = k == 0 ? 0.0 : indices[k - 1];
        panel.high = indices[k];
        panel.widest = root_of_difference(panel.high, panel.low) / panel.high;
        const bool has_medium =
            std::find(scattering.begin(), scattering.end(), panel.high) != scattering.end();
        const bool is_next = k + 1 < indices.size() && are_close(panel.high, indices[k + 1]);
        panel.mapped = has_medium || is_next;
        panels_.push_back(panel);
    }
    const std::vector<int> counts = nodes_of(panels_, count, least);
    Eigen::Index size = 0;
    for (std::size_t p = 0; p < panels_.size(); ++p) {
        panels_[p].first = size;
        panels_[p].count = counts[p];
        size += counts[p];
    }
    t_.resize(size);
    weight_.resize(size);
    for (const RefractionPanel& panel : panels_) {
        const auto rule = math::gauss_legendre(int(panel.count), 0.0, 1.0);
        for (Eigen::Index i = 0; i < panel.count; ++i) {
            t_[panel.first + i] = rule.nodes[std::size_t(i)];
            weight_[panel.first + i] = rule.weights[std::size_t(i)];
        }
    }
}

RefractionGrid RefractionGrid::within(double index) const {
    RefractionGrid part = *this;
    const Eigen::Index count = nodes_below(index);
    part.t_ = t_.tail(count);
    part.weight_ = weight_.tail(count);
    std::erase_if(part.panels_, [&](const RefractionPanel& panel) { return panel.high > index; });
    for (RefractionPanel& panel : part.panels_) panel.first -= size() - count;
    return part;
}

// Panels determine their nodes.
bool RefractionGrid::operator==(const RefractionGrid& other) const {
    return panels_ == other.panels_;
}

Eigen::Index RefractionGrid::nodes_below(double index) const {
    Eigen::Index count = 0;
    for (const RefractionPanel& panel : panels_) {
        if (panel.high <= index) count += panel.count;
    }
    return count;
}

ZenithGrid RefractionGrid::in_medium(double index) const {
    const Eigen::Index count = nodes_below(index);
    ZenithGrid grid{Eigen::VectorXd(count), Eigen::VectorXd(count), {}};
    const Eigen::Index above = size() - count;
    for (const RefractionPanel& panel : panels_) {
        if (panel.high > index) continue;
        // n^2 mu dmu = high^2 c dc.
        const double n2 = index * index;
        const GridPanel& here = grid.panels.emplace_back(
            GridPanel{.count = panel.count,
                      .map = panel.mapped ? GridPanel::Map::squared : GridPanel::Map::straight,
                      .widest = panel.widest,
                      .factor = panel.high * panel.high / n2,
                      .offset = (index - panel.high) * (index + panel.high) / n2});
        for (Eigen::Index p = panel.first; p < panel.first + panel.count; ++p) {
            grid.mu[p - above] = here.cosine(t_[p]);
            grid.weights[p - above] = weight_[p] * here.slope(t_[p]);
        }
    }
    return grid;
}

double refracted_cosine(double index, double mu_air) {
    if (index == 1.0 || mu_air == 1.0) return mu_air;  // no rounding beyond the zenith
    return std::sqrt((index - 1.0) * (index + 1.0) + mu_air * mu_air) / index;
}

Directions refracted(const Directions& in_air, double index) {
    Directions inside = in_air;
    for (auto* cosines : {&inside.mu_in, &inside.mu_out}) {
        for (double& mu : *cosines) mu = refracted_cosine(index, mu);
    }
    return inside;
}

RequestedDirections refracted(const RequestedDirections& in_air, double index) {
    RequestedDirections inside;
    refract(in_air, index, inside);
    return inside;
}

void refract(const RequestedDirections& in_air, double index, RequestedDirections& inside) {
    inside = in_air;
    for (double& mu : inside.mu) mu = refracted_cosine(index, mu);
    if (!inside.beside.empty()) inside = with_cosines_beside(std::move(inside));
}

}  // namespace miebrdf::rte
