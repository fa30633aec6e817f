// The object that rays meet: a sphere, or a mesh through Embree.
#pragma once

#include <Eigen/Core>

#include <memory>
#include <optional>
#include <string>

#include "pipeline/render/mesh.h"

namespace miebrdf::render {

/// One object. All members are thread-safe once it is made.
class RayScene {
  public:
    /// @param radius  > 0
    static RayScene sphere(const Eigen::Vector3d& centre, double radius);
    /// @param name  of the object, for messages
    /// @throws InputError  for a mesh that validate() refuses
    static RayScene mesh(const TriangleMesh& mesh, const std::string& name);

    RayScene(RayScene&&) noexcept;
    RayScene& operator=(RayScene&&) noexcept;
    ~RayScene();

    std::optional<Hit> intersect(const Ray& ray) const;
    /// Whether anything lies on a ray that starts on the surface.
    bool occluded(const Ray& ray, double distance) const;

    const Bounds& bounds() const;
    bool has_uv() const;

  private:
    struct Data;
    explicit RayScene(std::unique_ptr<Data> data);
    std::unique_ptr<Data> data_;
};

/// Where a ray that leaves a hit should start, so that rounding does not make it meet the same
/// place again.
Eigen::Vector3d leave(const Hit& hit, const Eigen::Vector3d& direction, const Bounds& bounds);

}  // namespace miebrdf::render
