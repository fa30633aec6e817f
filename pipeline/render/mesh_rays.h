// A mesh that rays meet, as the plug-in embree offers it.
#pragma once

#include <memory>
#include <optional>

#include "pipeline/render/mesh.h"

namespace miebrdf::render {

/// Thread-safe once it is made.
class MeshRays {
  public:
    virtual ~MeshRays() = default;
    /// The normal is on the side of the facet's, which looks to either side of the ray.
    virtual std::optional<Hit> intersect(const Ray& ray) const = 0;
    virtual bool occluded(const Ray& ray, double distance) const = 0;
};

}  // namespace miebrdf::render
