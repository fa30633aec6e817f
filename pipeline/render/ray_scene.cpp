#include "pipeline/render/ray_scene.h"

#include <fmt/format.h>
#include <Eigen/Geometry>

#include <limits>
#include <stdexcept>

#include "pipeline/render/late_embree.h"
#include "pipeline/render/mesh.h"

namespace miebrdf::render {

namespace {

/// Embree works in single precision: 24 bits of coordinates as large as the object. Rays leave
/// from this share of its radius above the surface.
constexpr double kLift = 1e-5;

RTCRay to_embree(const Ray& ray, double distance) {
    RTCRay r{};
    r.org_x = float(ray.origin.x());
    r.org_y = float(ray.origin.y());
    r.org_z = float(ray.origin.z());
    r.dir_x = float(ray.direction.x());
    r.dir_y = float(ray.direction.y());
    r.dir_z = float(ray.direction.z());
    r.tfar = float(distance);
    r.mask = ~0U;
    return r;
}

struct DeviceRelease {
    void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
};
struct SceneRelease {
    void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
};

}  // namespace

struct RayScene::Data {
    std::optional<SphereObject> sphere;  ///< else the mesh that Embree keeps
    std::unique_ptr<RTCDeviceTy, DeviceRelease> device;
    std::unique_ptr<RTCSceneTy, SceneRelease> scene;
    Bounds bounds;
    bool has_uv = false;

    void start_embree() {
        device.reset(rtcNewDevice("threads=1"));
        if (!device) throw std::runtime_error("Embree cannot start on this machine");
        scene.reset(rtcNewScene(device.get()));
        // Rays must not slip through the edge between two triangles.
        rtcSetSceneFlags(scene.get(), RTC_SCENE_FLAG_ROBUST);
    }

    void finish(RTCGeometry geometry) {
        rtcCommitGeometry(geometry);
        rtcAttachGeometryByID(scene.get(), geometry, 0);
        rtcReleaseGeometry(geometry);
        rtcCommitScene(scene.get());
        const RTCError error = rtcGetDeviceError(device.get());
        if (error != RTC_ERROR_NONE) {
            throw std::runtime_error(
                fmt::format("Embree refuses the object (error {})", int(error)));
        }
    }

    Eigen::Vector3d interpolate(const RTCHit& hit, unsigned attribute) const {
        float value[3] = {};
        RTCInterpolateArguments wanted{};  // all other results are null: not wanted
        wanted.geometry = rtcGetGeometry(scene.get(), 0);
        wanted.primID = hit.primID;
        wanted.u = hit.u;
        wanted.v = hit.v;
        wanted.bufferType = RTC_BUFFER_TYPE_VERTEX_ATTRIBUTE;
        wanted.bufferSlot = attribute;
        wanted.P = value;
        wanted.valueCount = 3;
        rtcInterpolate(&wanted);
        return Eigen::Vector3f(value[0], value[1], value[2]).cast<double>();
    }

    std::optional<Hit> intersect_mesh(const Ray& ray) const;
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
    data->start_embree();
    data->bounds = bounds_of(mesh);
    data->has_uv = !mesh.uv.empty();
    RTCGeometry geometry = rtcNewGeometry(data->device.get(), RTC_GEOMETRY_TYPE_TRIANGLE);
    rtcSetGeometryVertexAttributeCount(geometry, 2);
    const std::size_t count = mesh.positions.size();
    const auto new_buffer = [&](RTCBufferType type, unsigned slot, RTCFormat format,
                                std::size_t stride, std::size_t items) {
        return rtcSetNewGeometryBuffer(geometry, type, slot, format, stride, items);
    };
    auto* positions = static_cast<float*>(
        new_buffer(RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), count));
    auto* normals = static_cast<float*>(new_buffer(RTC_BUFFER_TYPE_VERTEX_ATTRIBUTE, 0,
                                                   RTC_FORMAT_FLOAT3, 3 * sizeof(float), count));
    auto* uv = static_cast<float*>(new_buffer(RTC_BUFFER_TYPE_VERTEX_ATTRIBUTE, 1,
                                              RTC_FORMAT_FLOAT3, 3 * sizeof(float), count));
    for (std::size_t i = 0; i < count; ++i) {
        for (int axis = 0; axis < 3; ++axis) {
            *positions++ = mesh.positions[i][axis];
            *normals++ = mesh.normals[i][axis];
            *uv++ = data->has_uv && axis < 2 ? mesh.uv[i][axis] : 0.0F;
        }
    }
    auto* corners =
        static_cast<std::uint32_t*>(new_buffer(RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                               3 * sizeof(std::uint32_t), mesh.triangles.size()));
    for (const auto& triangle : mesh.triangles) {
        for (const std::uint32_t corner : triangle) *corners++ = corner;
    }
    data->finish(geometry);
    return RayScene(std::move(data));
}

std::optional<Hit> RayScene::Data::intersect_mesh(const Ray& ray) const {
    RTCRayHit query{};
    query.ray = to_embree(ray, std::numeric_limits<double>::infinity());
    query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcIntersect1(scene.get(), &context, &query);
    if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;

    Hit hit;
    hit.position = ray.origin + double(query.ray.tfar) * ray.direction;
    hit.facet_normal = Eigen::Vector3d(query.hit.Ng_x, query.hit.Ng_y, query.hit.Ng_z).normalized();
    hit.normal = interpolate(query.hit, 0).normalized();
    // Some files list corners clockwise while their normals point outwards.
    if (hit.normal.dot(hit.facet_normal) < 0.0) hit.normal = -hit.normal;
    hit.uv.setZero();
    if (has_uv) hit.uv = interpolate(query.hit, 1).head<2>();
    return hit;
}

std::optional<Hit> RayScene::intersect(const Ray& ray) const {
    auto met = data_->sphere ? data_->sphere->intersect(ray) : data_->intersect_mesh(ray);
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
    RTCRay query = to_embree(ray, distance);
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcOccluded1(data_->scene.get(), &context, &query);
    return query.tfar < 0.0F;
}

Eigen::Vector3d leave(const Hit& hit, const Eigen::Vector3d& direction, const Bounds& bounds) {
    const double side = direction.dot(hit.facet_normal) >= 0.0 ? 1.0 : -1.0;
    const double scale = bounds.radius + bounds.centre().norm();
    return hit.position + side * kLift * scale * hit.facet_normal;
}

}  // namespace miebrdf::render
