#include <algorithm>
#include <cmath>
#include <numbers>

#include "pipeline/render/environment.h"

namespace miebrdf::render {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr int kHeight = 256;

/// ISO 15469:2004 / CIE S 011, sky type 12 ("CIE standard clear sky, low luminance turbidity"):
/// gradation phi(Z) = 1 + a exp(b / cos Z), indicatrix f(chi) = 1 + c (exp(d chi) - exp(d pi/2))
/// + e cos^2 chi, Z the angle from the zenith and chi that from the sun.
double clear_sky_luminance(double cos_zenith, double chi) {
    constexpr double a = -1.0, b = -0.32, c = 10.0, d = -3.0, e = 0.45;
    const double gradation = 1 + a * std::exp(b / std::max(cos_zenith, 1e-3));
    const double cos_chi = std::cos(chi);
    const double indicatrix =
        1 + c * (std::exp(d * chi) - std::exp(d * kPi / 2)) + e * cos_chi * cos_chi;
    return gradation * indicatrix;
}

}  // namespace

Image clear_sky_map(const Eigen::Vector3d& sun, double sky_irradiance, double ground_radiance) {
    Image map(2 * kHeight, kHeight, 3);
    double irradiance = 0.0;
    for (int y = 0; y < kHeight; ++y) {
        const double colatitude = (y + 0.5) / kHeight * kPi;
        const double cos_zenith = std::cos(colatitude), sin_zenith = std::sin(colatitude);
        for (int x = 0; x < map.width; ++x) {
            const double longitude = ((x + 0.5) / map.width - 0.5) * 2 * kPi;
            const Eigen::Vector3d direction(sin_zenith * std::sin(longitude), cos_zenith,
                                            -sin_zenith * std::cos(longitude));
            float* pixel = map.pixel(x, y);
            if (cos_zenith <= 0.0) {
                pixel[1] = float(ground_radiance);
                continue;
            }
            const double chi = std::acos(std::clamp(direction.dot(sun), -1.0, 1.0));
            pixel[0] = float(clear_sky_luminance(cos_zenith, chi));
            irradiance +=
                double(pixel[0]) * cos_zenith * sin_zenith * kPi * kPi / (kHeight * kHeight);
        }
    }
    const auto scale = float(sky_irradiance / irradiance);
    for (std::size_t i = 0; i < map.values.size(); i += 3) map.values[i] *= scale;
    return map;
}

}  // namespace miebrdf::render
