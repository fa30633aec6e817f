// The plug-in embree: rays and meshes by Embree 3 or 4.
#ifdef MIEBRDF_EMBREE_4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include <fmt/format.h>
#include <Eigen/Geometry>

#include <limits>
#include <stdexcept>

#include "pipeline/render/mesh_rays.h"

namespace miebrdf::render {
namespace {

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

class EmbreeMesh : public MeshRays {
  public:
    explicit EmbreeMesh(const TriangleMesh& mesh) : has_uv_(!mesh.uv.empty()) {
        device_.reset(rtcNewDevice("threads=1"));
        if (!device_) throw std::runtime_error("Embree cannot start on this machine");
        scene_.reset(rtcNewScene(device_.get()));
        // Rays must not slip through the edge between two triangles.
        rtcSetSceneFlags(scene_.get(), RTC_SCENE_FLAG_ROBUST);
        RTCGeometry geometry = rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_TRIANGLE);
        fill(geometry, mesh);
        rtcCommitGeometry(geometry);
        rtcAttachGeometryByID(scene_.get(), geometry, 0);
        rtcReleaseGeometry(geometry);
        rtcCommitScene(scene_.get());
        const RTCError error = rtcGetDeviceError(device_.get());
        if (error != RTC_ERROR_NONE) {
            throw std::runtime_error(
                fmt::format("Embree refuses the object (error {})", int(error)));
        }
    }

    std::optional<Hit> intersect(const Ray& ray) const override {
        RTCRayHit query{};
        query.ray = to_embree(ray, std::numeric_limits<double>::infinity());
        query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
#ifdef MIEBRDF_EMBREE_4
        rtcIntersect1(scene_.get(), &query);
#else
        RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        rtcIntersect1(scene_.get(), &context, &query);
#endif
        if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;

        Hit hit;
        hit.position = ray.origin + double(query.ray.tfar) * ray.direction;
        hit.facet_normal =
            Eigen::Vector3d(query.hit.Ng_x, query.hit.Ng_y, query.hit.Ng_z).normalized();
        hit.normal = interpolate(query.hit, 0).normalized();
        // Some files list corners clockwise while their normals point outwards.
        if (hit.normal.dot(hit.facet_normal) < 0.0) hit.normal = -hit.normal;
        hit.uv.setZero();
        if (has_uv_) hit.uv = interpolate(query.hit, 1).head<2>();
        return hit;
    }

    bool occluded(const Ray& ray, double distance) const override {
        RTCRay query = to_embree(ray, distance);
#ifdef MIEBRDF_EMBREE_4
        rtcOccluded1(scene_.get(), &query);
#else
        RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        rtcOccluded1(scene_.get(), &context, &query);
#endif
        return query.tfar < 0.0F;
    }

  private:
    void fill(RTCGeometry geometry, const TriangleMesh& mesh) const {
        rtcSetGeometryVertexAttributeCount(geometry, 2);
        const std::size_t count = mesh.positions.size();
        const auto new_buffer = [&](RTCBufferType type, unsigned slot, RTCFormat format,
                                    std::size_t stride, std::size_t items) {
            return rtcSetNewGeometryBuffer(geometry, type, slot, format, stride, items);
        };
        auto* positions = static_cast<float*>(
            new_buffer(RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), count));
        auto* normals = static_cast<float*>(new_buffer(
            RTC_BUFFER_TYPE_VERTEX_ATTRIBUTE, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), count));
        auto* uv = static_cast<float*>(new_buffer(RTC_BUFFER_TYPE_VERTEX_ATTRIBUTE, 1,
                                                  RTC_FORMAT_FLOAT3, 3 * sizeof(float), count));
        for (std::size_t i = 0; i < count; ++i) {
            for (int axis = 0; axis < 3; ++axis) {
                *positions++ = mesh.positions[i][axis];
                *normals++ = mesh.normals[i][axis];
                *uv++ = has_uv_ && axis < 2 ? mesh.uv[i][axis] : 0.0F;
            }
        }
        auto* corners = static_cast<std::uint32_t*>(
            new_buffer(RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(std::uint32_t),
                       mesh.triangles.size()));
        for (const auto& triangle : mesh.triangles) {
            for (const std::uint32_t corner : triangle) *corners++ = corner;
        }
    }

    Eigen::Vector3d interpolate(const RTCHit& hit, unsigned attribute) const {
        float value[3] = {};
        RTCInterpolateArguments wanted{};  // all other results are null: not wanted
        wanted.geometry = rtcGetGeometry(scene_.get(), 0);
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

    std::unique_ptr<RTCDeviceTy, DeviceRelease> device_;
    std::unique_ptr<RTCSceneTy, SceneRelease> scene_;
    bool has_uv_;
};

}  // namespace
}  // namespace miebrdf::render

extern "C" __attribute__((visibility("default"))) miebrdf::render::MeshRays* miebrdf_mesh_rays(
    const miebrdf::render::TriangleMesh& mesh) {
    return new miebrdf::render::EmbreeMesh(mesh);
}
