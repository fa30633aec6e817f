#include "pipeline/render/first_order_table.h"

#include <cmath>
#include <numbers>

#include "pipeline/render/cubic_taps.h"

namespace miebrdf::render {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr int kAngles = 600;
/// Share by which the middle is thinned in favour of the ends.
constexpr double kThinning = 0.9;

std::vector<double> nodes_deg() {
    std::vector<double> angles;
    for (int i = 0; i <= kAngles; ++i) {
        const double s = double(i) / kAngles;
        const double turn = 2 * std::numbers::pi;
        angles.push_back(180.0 * (s - kThinning * std::sin(turn * s) / turn));
    }
    angles.back() = 180.0;
    return angles;
}

}  // namespace

FirstOrderTable::FirstOrderTable(const std::vector<std::vector<rte::ScaledMedium>>& stacks)
    : angles_deg_(nodes_deg()) {
    for (const auto& media : stacks) {
        auto& layers = stacks_.emplace_back();
        for (auto medium = media.rbegin(); medium != media.rend(); ++medium) {
            const double strength =
                medium->exact.single_scattering_albedo / medium->scaled.depth_factor;
            layers.push_back({medium->optical_depth, phase_.size()});
            auto& row = phase_.emplace_back();
            for (const double angle : angles_deg_) {
                row.push_back(strength * rte::exact_phase(medium->exact, std::cos(angle * kDegree)));
            }
        }
    }
}

void FirstOrderTable::add(double mu_in, double mu_out, double cos_azimuth,
                          std::span<double> reflection) const {
    const double cos_theta = rte::cos_scattering_angle(mu_in, mu_out, cos_azimuth);
    const CubicTaps taps = taps_at(std::acos(cos_theta) / kDegree, angles_deg_);
    const double q = 1.0 / mu_in + 1.0 / mu_out;
    const double shape = 1.0 / (4.0 * (mu_in + mu_out));
    for (std::size_t w = 0; w < reflection.size(); ++w) {
        double above = shape;  // times what is left of the light on its way through upper layers
        for (const Layer& layer : stacks_[w]) {
            const double* p = &phase_[layer.row][taps.first];
            const double phase = taps.weight[0] * p[0] + taps.weight[1] * p[1] +
                                 taps.weight[2] * p[2] + taps.weight[3] * p[3];
            const double left = std::exp(-layer.optical_depth * q);
            reflection[w] += above * phase * (1.0 - left);
            above *= left;
        }
    }
}

}  // namespace miebrdf::render
