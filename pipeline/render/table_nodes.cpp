#include "pipeline/render/table_nodes.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace miebrdf::render {
namespace {

constexpr double kFirstRoot = 0.01;

}  // namespace

std::vector<double> cosine_nodes(int count) {
    std::vector<double> nodes;
    for (int i = 0; i < count; ++i) {
        const double root = kFirstRoot + (1.0 - kFirstRoot) * i / (count - 1);
        nodes.push_back(std::min(1.0, root * root));
    }
    nodes.back() = 1.0;
    return nodes;
}

CubicTaps cosine_taps(double mu, std::size_t count) {
    return uniform_taps((std::sqrt(mu) - kFirstRoot) / (1.0 - kFirstRoot) * double(count - 1), count);
}

std::vector<double> azimuth_nodes_deg(int count) {
    std::vector<double> nodes;
    for (int a = 0; a < count; ++a) nodes.push_back(180.0 * std::pow(double(a) / (count - 1), 1.5));
    return nodes;
}

CubicTaps azimuth_taps(double cos_azimuth, std::size_t count) {
    const double azimuth = std::acos(std::clamp(cos_azimuth, -1.0, 1.0));
    return uniform_taps(std::pow(azimuth / std::numbers::pi, 2.0 / 3.0) * double(count - 1), count);
}

}  // namespace miebrdf::render
