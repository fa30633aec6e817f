#include "pipeline/render/renderer.h"

#include <fmt/format.h>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <stdexcept>

#include "pipeline/render/path.h"
#include "pipeline/solve/parallel.h"

namespace miebrdf::render {

Camera::Camera(const Bounds& object, const Eigen::Vector3d& towards_camera,
               double field_of_view_deg, double zoom, double aspect)
    : orthographic_(field_of_view_deg == 0.0) {
    if (!(field_of_view_deg >= 0.0 && field_of_view_deg <= 120.0)) {
        throw std::invalid_argument(fmt::format(
            "field of view {} degrees; allowed: 0 (parallel) to 120", field_of_view_deg));
    }
    if (!(zoom > 0.0)) throw std::invalid_argument(fmt::format("zoom {}; allowed: above 0", zoom));
    forward_ = -towards_camera.normalized();
    const Eigen::Vector3d right = forward_.cross(Eigen::Vector3d::UnitY());
    if (!(right.norm() > 1e-6)) throw std::invalid_argument("the camera looks straight up or down");
    right_ = right.normalized();
    up_ = right_.cross(forward_);

    const double radius = object.radius;
    const double half_angle = 0.5 * field_of_view_deg * std::numbers::pi / 180;
    // The tangent cone of the bounding sphere fills the field of view at this distance.
    const double distance = orthographic_ ? 4 * radius : radius / std::sin(half_angle);
    const double half_size = (orthographic_ ? radius : std::tan(half_angle)) / zoom;
    eye_ = object.centre() - distance * forward_;
    right_ *= half_size * std::max(1.0, aspect);
    up_ *= half_size * std::max(1.0, 1.0 / aspect);
}

Ray Camera::ray(double x, double y) const {
    const Eigen::Vector3d offset = (2 * x - 1) * right_ + (1 - 2 * y) * up_;
    if (orthographic_) return {eye_ + offset, forward_};
    return {eye_, (forward_ + offset).normalized()};
}

namespace {

/// Side of the square of pixels that is one job.
constexpr int kTile = 16;

void require(const char* name, int value, int lowest, int highest) {
    if (value >= lowest && value <= highest) return;
    throw std::invalid_argument(
        fmt::format("{} {}; allowed: {} to {}", name, value, lowest, highest));
}

void require_spectra(const RenderScene& scene) {
    if (scene.materials.empty()) throw std::invalid_argument("no material to render");
    const std::size_t count = scene.materials.front()->wavelengths();
    const auto check = [&](std::size_t length, const char* what) {
        if (length == count) return;
        throw std::invalid_argument(
            fmt::format("{} has {} wavelengths; the first material has {}", what, length, count));
    };
    for (const auto& material : scene.materials) check(material->wavelengths(), "a material");
    for (const auto& light : scene.lighting.directional) check(light.irradiance.size(), "a light");
    for (const auto& light : scene.lighting.area) check(light.radiance.size(), "a light");
    if (scene.lighting.environment)
        check(scene.lighting.environment->wavelengths(), "the environment");
}

/// Squared noise and mean of what the pixels of a tile show, for the report.
struct Statistics {
    double squared_error = 0.0;
    double sum = 0.0;
    double pixels = 0.0;
    double all = 0.0, clamped = 0.0;  ///< light of all paths, and what was taken away of it
};

class TileRenderer {
  public:
    TileRenderer(const RenderScene& scene, const Camera& camera, const RenderOptions& options,
                 SpectralPicture& picture)
        : camera_(camera),
          options_(options),
          picture_(picture),
          tracer_(scene, options),
          half_{std::vector<double>(std::size_t(picture.radiance.channels)),
                std::vector<double>(std::size_t(picture.radiance.channels))},
          direct_(half_[0].size()),
          indirect_(half_[0].size()) {}

    Statistics render(int tile_x, int tile_y) {
        Statistics statistics;
        for (int y = tile_y; y < std::min(tile_y + kTile, options_.height); ++y) {
            for (int x = tile_x; x < std::min(tile_x + kTile, options_.width); ++x) {
                render_pixel(x, y, statistics);
            }
        }
        return statistics;
    }

  private:
    void render_pixel(int x, int y, Statistics& statistics) {
        for (auto& half : half_) std::fill(half.begin(), half.end(), 0.0);
        int met = 0;
        for (int s = 0; s < options_.samples; ++s) {
            Sampler sampler(std::uint32_t(x), std::uint32_t(y), options_.seed, std::uint32_t(s));
            const auto in_pixel = sampler.next();
            const Ray ray = camera_.ray((x + in_pixel[0]) / options_.width,
                                        (y + in_pixel[1]) / options_.height);
            // The first and the second half of the samples are each well spread.
            std::fill(direct_.begin(), direct_.end(), 0.0);
            std::fill(indirect_.begin(), indirect_.end(), 0.0);
            met += tracer_.trace(ray, sampler, direct_, indirect_);
            const double brought = std::accumulate(indirect_.begin(), indirect_.end(), 0.0);
            const double most = options_.clamp * double(indirect_.size());
            const double factor = most > 0.0 && brought > most ? most / brought : 1.0;
            statistics.all += std::accumulate(direct_.begin(), direct_.end(), brought);
            statistics.clamped += (1.0 - factor) * brought;
            auto& half = half_[2 * s < options_.samples ? 0 : 1];
            for (std::size_t w = 0; w < direct_.size(); ++w) {
                half[w] += direct_[w] + factor * indirect_[w];
            }
        }
        *picture_.coverage.pixel(x, y) = float(met) / float(options_.samples);
        float* pixel = picture_.radiance.pixel(x, y);
        double sum = 0.0, difference = 0.0;
        for (std::size_t w = 0; w < half_[0].size(); ++w) {
            pixel[w] = float((half_[0][w] + half_[1][w]) / options_.samples);
            sum += (half_[0][w] + half_[1][w]) / options_.samples;
            difference += (half_[0][w] - half_[1][w]) / options_.samples;
        }
        if (met < options_.samples) return;  // an edge's difference is geometry, not noise
        statistics.sum += sum;
        // Half the difference of two half-means has the standard error of their mean.
        statistics.squared_error += difference * difference;
        statistics.pixels += 1.0;
    }

    const Camera& camera_;
    const RenderOptions& options_;
    SpectralPicture& picture_;
    PathTracer tracer_;
    std::array<std::vector<double>, 2> half_;
    std::vector<double> direct_, indirect_;  ///< what one path brings
};

}  // namespace

SpectralPicture render_picture(const RenderScene& scene, const Camera& camera,
                               const RenderOptions& options, const Control& control) {
    require("width", options.width, 1, kLongestSide);
    require("height", options.height, 1, kLongestSide);
    require("samples", options.samples, 1, 1 << 24);
    require("bounces", options.bounces, 1, 1000);
    if (!(options.clamp >= 0.0 && std::isfinite(options.clamp))) {
        throw std::invalid_argument(
            fmt::format("clamp {}; allowed: 0 (none) or a radiance above", options.clamp));
    }
    require_spectra(scene);

    SpectralPicture picture;
    picture.radiance =
        Image(options.width, options.height, int(scene.materials.front()->wavelengths()));
    picture.coverage = Image(options.width, options.height, 1);
    const int columns = (options.width + kTile - 1) / kTile;
    const int rows = (options.height + kTile - 1) / kTile;
    std::vector<Statistics> statistics(std::size_t(columns) * std::size_t(rows));
    run_parallel("rendering", statistics.size(), control, [&](std::size_t tile) {
        TileRenderer renderer(scene, camera, options, picture);
        statistics[tile] =
            renderer.render(int(tile) % columns * kTile, int(tile) / columns * kTile);
    });

    Statistics total;  // summed in the order of tiles, whoever rendered them
    for (const Statistics& tile : statistics) {
        total.squared_error += tile.squared_error;
        total.sum += tile.sum;
        total.pixels += tile.pixels;
        total.all += tile.all;
        total.clamped += tile.clamped;
    }
    if (total.all > 0.0) picture.clamped = total.clamped / total.all;
    if (total.sum > 0.0) {
        picture.noise = std::sqrt(total.squared_error / total.pixels) / (total.sum / total.pixels);
    }
    return picture;
}

}  // namespace miebrdf::render
