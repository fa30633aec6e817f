#include "pipeline/render/path.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

namespace miebrdf::render {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Cosines below this count as below the horizon: BRDFs may grow like 1/mu, and single-precision
/// hits do not tell such angles apart.
constexpr double kHorizon = 1e-5;

}  // namespace

/// A point of the object where a path is reflected.
struct PathTracer::Vertex {
    Hit hit;
    Eigen::Vector3d towards_viewer;
    double mu_out;
    const RenderBrdf* material;
    DirectionSampler directions;
};

PathTracer::PathTracer(const RenderScene& scene, const RenderOptions& options)
    : scene_(scene),
      options_(options),
      throughput_(scene.materials.front()->wavelengths()),
      brdf_(throughput_.size()),
      emitted_(throughput_.size()) {}

/// Puts the BRDF into brdf_.
/// @return  the cosine of the light, 0 where it shines from below
double PathTracer::evaluate(const Vertex& vertex, const Eigen::Vector3d& towards_light) {
    const double mu_in = towards_light.dot(vertex.hit.normal);
    if (!(mu_in > kHorizon && towards_light.dot(vertex.hit.facet_normal) > 0.0)) return 0.0;
    const double in = std::min(mu_in, 1.0), out = vertex.mu_out;
    const double sines = std::sqrt((1 - in) * (1 + in) * (1 - out) * (1 + out));
    const double cosine = (in * out - towards_light.dot(vertex.towards_viewer)) / sines;
    // With either direction along the normal there is no azimuth; any will do.
    const double cos_azimuth = sines > 1e-12 ? std::clamp(cosine, -1.0, 1.0) : 1.0;
    vertex.material->evaluate(in, out, cos_azimuth, brdf_);
    return in;
}

void PathTracer::add_directional(const Vertex& vertex, std::span<double> radiance) {
    for (const DirectionalLight& light : scene_.lighting.directional) {
        const double mu_in = light.towards.dot(vertex.hit.normal);
        if (!(mu_in > kHorizon && light.towards.dot(vertex.hit.facet_normal) > 0.0)) continue;
        const Eigen::Vector3d start = leave(vertex.hit, light.towards, scene_.object.bounds());
        if (scene_.object.occluded({start, light.towards}, kInfinity)) continue;
        evaluate(vertex, light.towards);
        for (std::size_t w = 0; w < radiance.size(); ++w) {
            radiance[w] += throughput_[w] * brdf_[w] * mu_in * light.irradiance[w];
        }
    }
}

void PathTracer::add_area(const Vertex& vertex, Sampler& sampler, std::span<double> radiance) {
    for (const AreaLight& light : scene_.lighting.area) {
        const auto u = sampler.next();
        const Eigen::Vector3d point =
            light.centre + (2 * u[0] - 1) * light.half_width + (2 * u[1] - 1) * light.half_height;
        const Eigen::Vector3d path = point - vertex.hit.position;
        const double distance = path.norm();
        const Eigen::Vector3d towards = path / distance;
        const Eigen::Vector3d area = 4 * light.half_width.cross(light.half_height);
        const double solid_angle = -area.dot(towards) / (distance * distance);
        if (!(solid_angle > 0.0)) continue;
        const double mu_in = evaluate(vertex, towards);
        if (mu_in == 0.0) continue;
        const Eigen::Vector3d start = leave(vertex.hit, towards, scene_.object.bounds());
        if (scene_.object.occluded({start, towards}, distance)) continue;
        for (std::size_t w = 0; w < radiance.size(); ++w) {
            radiance[w] += throughput_[w] * brdf_[w] * mu_in * solid_angle * light.radiance[w];
        }
    }
}

void PathTracer::add_environment(const Vertex& vertex, Sampler& sampler,
                                 std::span<double> radiance) {
    const Environment& environment = *scene_.lighting.environment;
    if (!environment.has_density()) return;
    const Environment::Sample sample = environment.sample(sampler.next());
    if (!(sample.density > 0.0)) return;
    const double mu_in = evaluate(vertex, sample.direction);
    if (mu_in == 0.0) return;
    const Eigen::Vector3d start = leave(vertex.hit, sample.direction, scene_.object.bounds());
    if (scene_.object.occluded({start, sample.direction}, kInfinity)) return;
    environment.radiance(sample.direction, emitted_);
    const double factor = mu_in / (sample.density + vertex.directions.density(sample.direction));
    for (std::size_t w = 0; w < radiance.size(); ++w) {
        radiance[w] += throughput_[w] * brdf_[w] * factor * emitted_[w];
    }
}

void PathTracer::add_escaped(const Eigen::Vector3d& direction, double weight,
                             std::span<double> radiance) {
    scene_.lighting.environment->radiance(direction, emitted_);
    for (std::size_t w = 0; w < radiance.size(); ++w) {
        radiance[w] += weight * throughput_[w] * emitted_[w];
    }
}

bool PathTracer::trace(Ray ray, Sampler& sampler, std::span<double> radiance) {
    std::fill(throughput_.begin(), throughput_.end(), 1.0);
    const auto& environment = scene_.lighting.environment;
    double density = 0.0;  // of the ray's direction, once it was sampled
    for (int reflections = 0;; ++reflections) {
        const auto hit = scene_.object.intersect(ray);
        const bool is_seen = reflections > 0 || options_.environment_visible;
        if (!hit) {
            if (!environment || !is_seen) return reflections > 0;
            const bool two_ways = reflections > 0 && environment->has_density();
            const double other = two_ways ? environment->density(ray.direction) : 0.0;
            add_escaped(ray.direction, two_ways ? density / (density + other) : 1.0, radiance);
            return true;
        }
        if (reflections == options_.bounces) return true;

        const double mu_out = std::min(1.0, -ray.direction.dot(hit->normal));
        if (!(mu_out > kHorizon)) return true;
        const RenderBrdf& material = *scene_.materials[scene_.map.material_at(*hit)];
        const Vertex vertex{*hit, -ray.direction, mu_out, &material,
                            DirectionSampler(hit->normal, -ray.direction, material.lobe_alpha())};
        add_directional(vertex, radiance);
        add_area(vertex, sampler, radiance);
        if (environment) add_environment(vertex, sampler, radiance);

        const Eigen::Vector3d direction = vertex.directions.sample(sampler.next());
        density = vertex.directions.density(direction);
        const double mu_in = evaluate(vertex, direction);
        if (!(mu_in > 0.0 && density > 0.0)) return true;
        for (std::size_t w = 0; w < throughput_.size(); ++w) {
            throughput_[w] *= brdf_[w] * mu_in / density;
        }
        ray = {leave(*hit, direction, scene_.object.bounds()), direction};
    }
}

}  // namespace miebrdf::render
