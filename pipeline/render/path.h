// One path of light, followed backwards from the camera, for all wavelengths at once.
#pragma once

#include <span>

#include "pipeline/render/renderer.h"
#include "pipeline/render/sampler.h"

namespace miebrdf::render {

/// Traces paths in a scene; keeps its buffers from one to the next, so one for each thread.
class PathTracer {
  public:
    PathTracer(const RenderScene& scene, const RenderOptions& options);

    /// Adds the radiance that arrives along a ray: to `direct` what was reflected once or not at
    /// all, to `indirect` the rest.
    /// @return  whether the ray met the object or a visible environment
    bool trace(Ray ray, Sampler& sampler, std::span<double> direct, std::span<double> indirect);

  private:
    struct Vertex;
    void add_directional(const Vertex& vertex, std::span<double> radiance);
    void add_area(const Vertex& vertex, Sampler& sampler, std::span<double> radiance);
    void add_environment(const Vertex& vertex, Sampler& sampler, std::span<double> radiance);
    void add_escaped(const Eigen::Vector3d& direction, double weight, std::span<double> radiance);
    void evaluate(const Vertex& vertex, const Eigen::Vector3d& towards_light, double mu_in);
    void reflect(const Vertex& vertex, const Eigen::Vector3d& towards_light, double density);

    const RenderScene& scene_;
    const RenderOptions& options_;
    std::vector<double> throughput_;
    std::vector<double> brdf_;
    std::vector<double> emitted_;
};

}  // namespace miebrdf::render
