// Layout: three 32-bit extents, then doubles [channel][theta_h][theta_d][phi_d].
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "tests/support/outside/bytes.h"
#include "tests/support/outside/outside_file.h"

namespace miebrdf::support {
namespace {

constexpr std::array<double, 3> kScale = {1.0 / 1500, 1.15 / 1500, 1.66 / 1500};

/// Rusinkiewicz 1998: angles of the half vector, and of the light in the frame about it whose x
/// axis points down its meridian.
struct Angles {
    double theta_h, theta_d, phi_d;
};

Angles half_and_difference(const Vector& light, const Vector& viewer) {
    const Vector half = (light + viewer).normalized();
    const double theta = std::acos(std::clamp(half.z(), -1.0, 1.0));
    const double phi = std::atan2(half.y(), half.x());
    const Vector x(std::cos(theta) * std::cos(phi), std::cos(theta) * std::sin(phi),
                   -std::sin(theta));
    const Vector y(-std::sin(phi), std::cos(phi), 0);
    const double turned = std::atan2(light.dot(y), light.dot(x));
    return {theta, std::acos(std::clamp(light.dot(half), -1.0, 1.0)),
            turned < 0 ? turned + std::numbers::pi : turned};
}

class MerlBins : public OutsideFile {
  public:
    explicit MerlBins(const std::string& bytes)
        : values_(numbers_at<double>(bytes, 12, 3 * 90 * 90 * 180)) {}

    std::vector<double> brdf(const Vector& light, const Vector& viewer) const override {
        const Angles a = half_and_difference(light, viewer);
        const int h = std::clamp(int(90 * std::sqrt(a.theta_h / (std::numbers::pi / 2))), 0, 89);
        const int d = std::clamp(int(90 * a.theta_d / (std::numbers::pi / 2)), 0, 89);
        const int p = std::clamp(int(180 * a.phi_d / std::numbers::pi), 0, 179);
        return {value(0, h, d, p), value(1, h, d, p), value(2, h, d, p)};
    }

  protected:
    double value(int channel, int h, int d, int p) const {
        const auto index = static_cast<std::size_t>(p + 180 * (d + 90 * (h + 90 * channel)));
        return std::max(0.0, values_[index]) * kScale[static_cast<std::size_t>(channel)];
    }

  private:
    std::vector<double> values_;
};

/// libbsdf: 91 half angles i^2 / 90 degrees, 91 difference angles, 361 azimuths, the last of each
/// repeating the bin before (or after a half turn, the first); bins without a value are 0.
class MerlInterpolated : public MerlBins {
  public:
    using MerlBins::MerlBins;

    std::vector<double> brdf(const Vector& light, const Vector& viewer) const override {
        const Angles a = half_and_difference(light, viewer);
        const double degrees = 180 / std::numbers::pi;
        const double theta_h = a.theta_h * degrees;
        const int h = std::clamp(int(std::sqrt(90 * theta_h)), 0, 89);
        const double low = h * h / 90.0, high = (h + 1) * (h + 1) / 90.0;
        const double share_h = (theta_h - low) / (high - low);
        const int d = std::clamp(int(a.theta_d * degrees), 0, 89);
        const double share_d = a.theta_d * degrees - d;
        const int p = std::clamp(int(a.phi_d * degrees), 0, 179);
        const double share_p = a.phi_d * degrees - p;
        std::vector<double> rgb(3, 0.0);
        for (int corner = 0; corner < 8; ++corner) {
            const int i = corner & 1, j = corner >> 1 & 1, k = corner >> 2;
            const double weight = (i ? share_h : 1 - share_h) * (j ? share_d : 1 - share_d) *
                                  (k ? share_p : 1 - share_p);
            for (int c = 0; c < 3; ++c) {
                rgb[static_cast<std::size_t>(c)] +=
                    weight * value(c, std::min(h + i, 89), std::min(d + j, 89), (p + k) % 180);
            }
        }
        return rgb;
    }
};

}  // namespace

std::unique_ptr<OutsideFile> merl_file(const std::string& bytes) {
    return std::make_unique<MerlInterpolated>(bytes);
}

std::unique_ptr<OutsideFile> merl_bins_file(const std::string& bytes) {
    return std::make_unique<MerlBins>(bytes);
}

}  // namespace miebrdf::support
