#include "pipeline/render/ray_scene.h"

#include <fmt/format.h>
#include <Eigen/Geometry>

#include <stdexcept>

#include "pipeline/io/plugin.h"
#include "pipeline/render/mesh_rays.h"

namespace miebrdf::render {

namespace {

/// Embree works in single precision: 24 bits of coordinates as large as the object. Rays leave
/// from this share of its radius above the surface.
constexpr double kLift = 1e-5;

}  // namespace

struct RayScene::Data {
    std::optional<SphereObject> sphere;
    std::unique_ptr<MeshRays> mesh;  ///< where there is no sphere
    Bounds bounds;
    bool has_uv = false;
};

RayScene::RayScene(std::unique_ptr<Data> data) : data_(std::move(data)) {}
RayScene::RayScene(RayScene&&) noexcept = default;
RayScene& RayScene::operator=(RayScene&&) noexcept = default;
RayScene::~RayScene() = default;

const Bounds& RayScene::bounds() const { return data_->bounds; }
bool RayScene::has_uv() const { return data_->has_uv; }

RayScene RayScene::sphere(const Eigen::Vector3d& centre, double radius) {
    if (!(radius > 0.0)) {
        throw std::invalid_argument(fmt::format("sphere radius {}; allowed: above 0", radius));
    }
    auto data = std::make_unique<Data>();
    const Eigen::Vector3d half = Eigen::Vector3d::Constant(radius);
    data->bounds = {centre - half, centre + half, radius};
    data->sphere = SphereObject{centre, radius};
    return RayScene(std::move(data));
}

RayScene RayScene::mesh(const TriangleMesh& mesh, const std::string& name) {
    validate(mesh, name);
    auto data = std::make_unique<Data>();
    static const auto make = plugin_function<MeshRays*(const TriangleMesh&)>(
        "embree", "miebrdf_mesh_rays", "libembree-dev");
    data->mesh.reset(make(mesh));
    data->bounds = bounds_of(mesh);
    data->has_uv = !mesh.uv.empty();
    return RayScene(std::move(data));
}

std::optional<Hit> RayScene::intersect(const Ray& ray) const {
    auto met = data_->sphere ? data_->sphere->intersect(ray) : data_->mesh->intersect(ray);
    if (!met) return std::nullopt;
    Hit& hit = *met;
    // Open meshes are seen from both sides. A shading normal that the ray sees from behind while
    // it sees the facet from the front is an artefact of smoothing: there the facet counts.
    if (hit.facet_normal.dot(ray.direction) > 0.0) {
        hit.facet_normal = -hit.facet_normal;
        hit.normal = -hit.normal;
    }
    if (!(hit.normal.dot(ray.direction) < 0.0)) hit.normal = hit.facet_normal;
    return met;
}

bool RayScene::occluded(const Ray& ray, double distance) const {
    if (data_->sphere) return data_->sphere->distance_along(ray) < distance;
    return data_->mesh->occluded(ray, distance);
}

Eigen::Vector3d leave(const Hit& hit, const Eigen::Vector3d& direction, const Bounds& bounds) {
    const double side = direction.dot(hit.facet_normal) >= 0.0 ? 1.0 : -1.0;
    const double scale = bounds.radius + bounds.centre().norm();
    return hit.position + side * kLift * scale * hit.facet_normal;
}

}  // namespace miebrdf::render
