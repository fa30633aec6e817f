#include "pipeline/phase_lookup.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace miebrdf {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

double angle_deg(double cos_theta) { return std::acos(std::clamp(cos_theta, -1.0, 1.0)) / kDegree; }

}  // namespace

PhaseLookup::PhaseLookup(std::vector<double> angles_deg, std::vector<double> phase)
    : angles_deg_(std::move(angles_deg)), phase_(std::move(phase)) {
    if (angles_deg_.size() != phase_.size() || angles_deg_.empty()) {
        throw std::invalid_argument(fmt::format("phase lookup: {} angles, {} values",
                                                angles_deg_.size(), phase_.size()));
    }
}

double PhaseLookup::operator()(double cos_theta) const {
    const double angle = angle_deg(cos_theta);
    auto found = std::lower_bound(angles_deg_.begin(), angles_deg_.end(), angle - kMatch_deg);
    if (found == angles_deg_.end() || !(std::abs(*found - angle) <= kMatch_deg)) {
        throw std::logic_error(fmt::format("phase function asked at {} degrees, which no requested "
                                           "direction scatters by", angle));
    }
    const auto next = found + 1;
    if (next != angles_deg_.end() && std::abs(*next - angle) < std::abs(*found - angle)) found = next;
    return phase_[static_cast<std::size_t>(found - angles_deg_.begin())];
}

std::vector<double> scattering_angles_deg(const std::vector<double>& mu_in,
                                          const std::vector<double>& mu_out,
                                          const std::vector<double>& azimuth_deg) {
    std::vector<double> angles;
    angles.reserve(mu_in.size() * mu_out.size() * azimuth_deg.size());
    for (const double in : mu_in) {
        const double sin_in = std::sqrt((1.0 - in) * (1.0 + in));
        for (const double out : mu_out) {
            const double sin_out = std::sqrt((1.0 - out) * (1.0 + out));
            for (const double azimuth : azimuth_deg) {
                const double cos_theta = -in * out + sin_in * sin_out * std::cos(azimuth * kDegree);
                angles.push_back(angle_deg(cos_theta));
            }
        }
    }
    std::sort(angles.begin(), angles.end());
    const auto merged = [](double kept, double next) {
        return next - kept < 0.5 * PhaseLookup::kMatch_deg;
    };
    angles.erase(std::unique(angles.begin(), angles.end(), merged), angles.end());
    return angles;
}

}  // namespace miebrdf
