#include "pipeline/render/table_nodes.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace miebrdf::render {

namespace {

/// Stands for the horizon, where (mu_in + mu_out) R has a limit but 0 is no direction.
constexpr double kHorizon = 1e-9;

/// Inverse of share_of_angle, in radians.
double angle_of_share(double y) { return 2.0 * std::atan2(y, 1.0 - y); }

template <typename Node>
std::vector<double> nodes_at(int count, const Node& node) {
    std::vector<double> nodes(static_cast<std::size_t>(count));
    for (int i = 0; i < count; ++i) nodes[std::size_t(i)] = node(double(i) / (count - 1));
    return nodes;
}

}  // namespace

double spread_inverse(double x) {
    // y = sin^2(psi): 2 x - 1 = sin(psi) - cos(psi) = sqrt(2) sin(psi - pi/4)
    const double psi = 0.25 * std::numbers::pi + std::asin((2.0 * x - 1.0) / std::numbers::sqrt2);
    return std::pow(std::sin(psi), 2);
}

std::vector<double> cosine_nodes(int count) {
    std::vector<double> nodes =
        nodes_at(count, [](double x) { return std::clamp(spread_inverse(x), kHorizon, 1.0); });
    nodes.back() = 1.0;
    return nodes;
}

std::vector<double> azimuth_nodes_deg(int count) {
    return nodes_at(count, [](double x) {
        return angle_of_share(std::pow(x, 4.0 / 3.0)) * 180.0 / std::numbers::pi;
    });
}

std::vector<double> scattering_angle_nodes(int count) {
    return nodes_at(count, [](double x) { return angle_of_share(spread_inverse(x)); });
}

}  // namespace miebrdf::render
