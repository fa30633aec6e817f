#include "pipeline/render/environment.h"

#include <fmt/format.h>
#include <miebrdf/error.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace miebrdf::render {

namespace {

constexpr double kPi = std::numbers::pi;

/// Position in the map, in pixels from its upper left corner.
struct MapPoint {
    double x;
    double y;
};

MapPoint to_map(const Eigen::Vector3d& d, const Image& map) {
    const double u = 0.5 + std::atan2(d.x(), -d.z()) / (2 * kPi);
    const double v = std::acos(std::clamp(d.y(), -1.0, 1.0)) / kPi;
    return {u * map.width, v * map.height};
}

Eigen::Vector3d from_map_point(double x, double y, const Image& map) {
    const double longitude = (x / map.width - 0.5) * 2 * kPi;
    const double colatitude = y / map.height * kPi;
    return {std::sin(colatitude) * std::sin(longitude), std::cos(colatitude),
            -std::sin(colatitude) * std::cos(longitude)};
}

void require_map(const Image& map, const std::string& name) {
    if (map.width != 2 * map.height || map.channels != 3) {
        throw InputError(
            fmt::format("{}: {} x {} pixels, {} channels; a latitude-longitude map is twice as "
                        "wide as high and "
                        "has 3 channels",
                        name, map.width, map.height, map.channels));
    }
    for (std::size_t i = 0; i < map.values.size(); ++i) {
        if (std::isfinite(map.values[i]) && map.values[i] >= 0.0F) continue;
        const std::size_t pixel = i / 3;
        throw InputError(fmt::format(
            "{}: pixel ({}, {}) is {}; radiance must be finite and not "
            "negative",
            name, pixel % std::size_t(map.width), pixel / std::size_t(map.width), map.values[i]));
    }
}

/// Index of the interval of a cumulated distribution that u falls into, and where in it.
std::pair<int, double> invert(const double* end, int count, double u) {
    const double total = end[count - 1];
    const int index = int(std::upper_bound(end, end + count, u * total) - end);
    const int k = std::min(index, count - 1);
    const double start = k == 0 ? 0.0 : end[k - 1];
    const double width = end[k] - start;
    return {k, width > 0.0 ? std::clamp((u * total - start) / width, 0.0, 1.0) : 0.5};
}

}  // namespace

Eigen::Vector3d direction_from_angles(double elevation_deg, double azimuth_deg) {
    const double elevation = elevation_deg * kPi / 180, azimuth = azimuth_deg * kPi / 180;
    return {std::cos(elevation) * std::sin(azimuth), std::sin(elevation),
            std::cos(elevation) * std::cos(azimuth)};
}

Environment Environment::uniform(Spectrum radiance) {
    Environment environment;
    environment.map_ = Image(1, 1, 3);
    environment.map_.values = {1.0F, 0.0F, 0.0F};
    environment.basis_.fill(Spectrum(radiance.size(), 0.0));
    environment.basis_[0] = std::move(radiance);
    return environment;
}

Environment Environment::from_map(const Image& map, const std::array<Spectrum, 3>& basis,
                                  const std::string& name) {
    require_map(map, name);
    Environment environment;
    environment.map_ = map;
    environment.basis_ = basis;
    environment.build_distribution();
    return environment;
}

void Environment::build_distribution() {
    const int width = map_.width, height = map_.height;
    row_end_.resize(std::size_t(height));
    column_end_.resize(std::size_t(height) * std::size_t(width));
    double sum_rows = 0.0;
    for (int y = 0; y < height; ++y) {
        const double sine = std::sin((y + 0.5) / height * kPi);
        double sum = 0.0;
        for (int x = 0; x < width; ++x) {
            // Interpolation spreads a pixel over its neighbours, so each gets their mean.
            double brightness = 0.0;
            for (int dy = -1; dy <= 1; ++dy) {
                for (int dx = -1; dx <= 1; ++dx) {
                    const float* p =
                        map_.pixel((x + dx + width) % width, std::clamp(y + dy, 0, height - 1));
                    brightness += double(p[0]) + double(p[1]) + double(p[2]);
                }
            }
            sum += brightness * sine;
            column_end_[std::size_t(y) * std::size_t(width) + std::size_t(x)] = sum;
        }
        row_end_[std::size_t(y)] = sum_rows += sum;
    }
    if (!(sum_rows > 0.0)) row_end_.clear();  // a black map: nothing to aim at
}

double Environment::pixel_probability(int x, int y) const {
    const std::size_t first = std::size_t(y) * std::size_t(map_.width);
    const double before = x == 0 ? 0.0 : column_end_[first + std::size_t(x) - 1];
    return (column_end_[first + std::size_t(x)] - before) / row_end_.back();
}

Environment::Sample Environment::sample(const std::array<double, 2>& u) const {
    const auto [y, in_y] = invert(row_end_.data(), map_.height, u[0]);
    const auto [x, in_x] =
        invert(&column_end_[std::size_t(y) * std::size_t(map_.width)], map_.width, u[1]);
    const Eigen::Vector3d direction = from_map_point(x + in_x, y + in_y, map_);
    return {direction, density(direction)};
}

double Environment::density(const Eigen::Vector3d& direction) const {
    const MapPoint p = to_map(direction, map_);
    const int x = std::clamp(int(p.x), 0, map_.width - 1);
    const int y = std::clamp(int(p.y), 0, map_.height - 1);
    const double sine = std::sqrt(std::max(1e-12, 1.0 - direction.y() * direction.y()));
    return pixel_probability(x, y) * map_.width * map_.height / (2 * kPi * kPi * sine);
}

void Environment::radiance(const Eigen::Vector3d& direction, std::span<double> values) const {
    if (map_.values.size() == 3) {  // the same from everywhere
        std::copy(basis_[0].begin(), basis_[0].end(), values.begin());
        return;
    }
    std::array<double, 3> weight{};
    const MapPoint p = to_map(direction, map_);
    const double fx = p.x - 0.5, fy = p.y - 0.5;
    const int x0 = int(std::floor(fx)), y0 = int(std::floor(fy));
    for (int dy = 0; dy <= 1; ++dy) {
        for (int dx = 0; dx <= 1; ++dx) {
            const double share =
                (dx == 0 ? 1 - (fx - x0) : fx - x0) * (dy == 0 ? 1 - (fy - y0) : fy - y0);
            const float* pixel = map_.pixel((x0 + dx + map_.width) % map_.width,
                                            std::clamp(y0 + dy, 0, map_.height - 1));
            for (std::size_t c = 0; c < 3; ++c) weight[c] += share * double(pixel[c]);
        }
    }
    for (std::size_t w = 0; w < values.size(); ++w) {
        values[w] = weight[0] * basis_[0][w] + weight[1] * basis_[1][w] + weight[2] * basis_[2][w];
    }
}

namespace {

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
