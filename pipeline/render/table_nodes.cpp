#include "pipeline/render/table_nodes.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace miebrdf::render {
namespace {

/// Stands for the horizon, where (mu_in + mu_out) R has a limit but 0 is no direction.
constexpr double kHorizon = 1e-9;

}  // namespace

std::vector<double> cosine_nodes(int count) {
    std::vector<double> nodes;
    for (int i = 0; i < count; ++i) {
        const double sine = std::sin(0.5 * std::numbers::pi * i / (count - 1));
        nodes.push_back(std::clamp(sine * sine, kHorizon, 1.0));
    }
    nodes.back() = 1.0;
    return nodes;
}

CubicTaps cosine_taps(double mu, std::size_t count) {
    return uniform_taps(2.0 / std::numbers::pi * std::asin(std::sqrt(mu)) * double(count - 1),
                        count);
}

std::vector<double> azimuth_nodes_deg(int count) {
    std::vector<double> nodes;
    for (int a = 0; a < count; ++a) nodes.push_back(180.0 * std::pow(double(a) / (count - 1), 1.5));
    return nodes;
}

CubicTaps azimuth_taps(double cos_azimuth, std::size_t count) {
    const double share = std::acos(std::clamp(cos_azimuth, -1.0, 1.0)) / std::numbers::pi;
    return uniform_taps(std::cbrt(share * share) * double(count - 1), count);
}

}  // namespace miebrdf::render
