#include "pipeline/render/path.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

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
    BounceSampler directions;

    Vertex(const Hit& where, const Eigen::Vector3d& viewer, double mu, const RenderBrdf& brdf)
        : hit(where),
          towards_viewer(viewer),
          mu_out(mu),
          material(&brdf),
          directions(where.normal, viewer, brdf.lobe_alpha()) {}

    /// The cosine of a light, 0 where it shines from below.
    double cosine(const Eigen::Vector3d& towards_light) const {
        const double mu_in = towards_light.dot(hit.normal);
        return mu_in > kHorizon && towards_light.dot(hit.facet_normal) > 0.0 ? mu_in : 0.0;
    }
};

PathTracer::PathTracer(const RenderScene& scene, const RenderOptions& options)
    : scene_(scene),
      options_(options),
      throughput_(scene.materials.front()->wavelengths()),
      brdf_(throughput_.size()),
      emitted_(throughput_.size()) {}

/// Puts the BRDF into brdf_.
void PathTracer::evaluate(const Vertex& vertex, const Eigen::Vector3d& towards_light,
                          double mu_in) {
    const double in = std::min(mu_in, 1.0), out = vertex.mu_out;
    const double sines = std::sqrt((1 - in) * (1 + in) * (1 - out) * (1 + out));
    const double cosine = (in * out - towards_light.dot(vertex.towards_viewer)) / sines;
    // With either direction along the normal there is no azimuth; any will do.
    const double cos_azimuth = sines > 1e-12 ? std::clamp(cosine, -1.0, 1.0) : 1.0;
    vertex.material->evaluate(in, out, cos_azimuth, brdf_);
}

/// Weakens the path by a reflection into a direction that was sampled.
void PathTracer::reflect(const Vertex& vertex, const Eigen::Vector3d& towards_light,
                         double density) {
    const double mu_in = vertex.cosine(towards_light);
    evaluate(vertex, towards_light, mu_in);
    for (std::size_t w = 0; w < throughput_.size(); ++w) {
        throughput_[w] *= brdf_[w] * mu_in / density;
    }
}

void PathTracer::add_directional(const Vertex& vertex, std::span<double> radiance) {
    for (const DirectionalLight& light : scene_.lighting.directional) {
        const double mu_in = vertex.cosine(light.towards);
        if (mu_in == 0.0) continue;
        const Eigen::Vector3d start = leave(vertex.hit, light.towards, scene_.object.bounds());
        if (scene_.object.occluded({start, light.towards}, kInfinity)) continue;
        evaluate(vertex, light.towards, mu_in);
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
        const double mu_in = vertex.cosine(towards);
        if (mu_in == 0.0) continue;
        const Eigen::Vector3d start = leave(vertex.hit, towards, scene_.object.bounds());
        if (scene_.object.occluded({start, towards}, distance)) continue;
        evaluate(vertex, towards, mu_in);
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
    const double mu_in = vertex.cosine(sample.direction);
    if (mu_in == 0.0) return;
    const Eigen::Vector3d start = leave(vertex.hit, sample.direction, scene_.object.bounds());
    if (scene_.object.occluded({start, sample.direction}, kInfinity)) return;
    evaluate(vertex, sample.direction, mu_in);
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

bool PathTracer::trace(Ray ray, Sampler& sampler, std::span<double> direct,
                       std::span<double> indirect) {
    std::fill(throughput_.begin(), throughput_.end(), 1.0);
    const auto& environment = scene_.lighting.environment;
    std::optional<Vertex> last;  // where the ray comes from, if not from the camera
    double density = 0.0;        // of its direction there
    for (int reflections = 0;; ++reflections) {
        const auto hit = scene_.object.intersect(ray);
        const bool sees_light = environment && (last || options_.environment_visible);
        if (hit ? reflections == options_.bounces : !sees_light) return hit || last;
        // Only here is it known that anything comes of the last reflection.
        if (last) reflect(*last, ray.direction, density);
        if (!hit) {
            const bool two_ways = last && environment->has_density();
            const double other = two_ways ? environment->density(ray.direction) : 0.0;
            add_escaped(ray.direction, two_ways ? density / (density + other) : 1.0,
                        reflections <= 1 ? direct : indirect);
            return true;
        }

        const double mu_out = std::min(1.0, -ray.direction.dot(hit->normal));
        if (!(mu_out > kHorizon)) return true;
        const RenderBrdf& material = *scene_.materials[scene_.map.material_at(*hit)];
        last.emplace(*hit, -ray.direction, mu_out, material);
        const std::span<double> radiance = reflections == 0 ? direct : indirect;
        add_directional(*last, radiance);
        add_area(*last, sampler, radiance);
        if (environment) add_environment(*last, sampler, radiance);

        const Eigen::Vector3d direction = last->directions.sample(sampler.next());
        density = last->directions.density(direction);
        if (!(last->cosine(direction) > 0.0 && density > 0.0)) return true;
        ray = {leave(*hit, direction, scene_.object.bounds()), direction};
    }
}

}  // namespace miebrdf::render
