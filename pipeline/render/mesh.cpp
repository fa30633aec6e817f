#include "pipeline/render/mesh.h"

#include <fmt/format.h>

#include <algorithm>

#include <miebrdf/error.h>

namespace miebrdf::render {

Bounds bounds_of(const TriangleMesh& mesh) {
    Eigen::Vector3f lower = mesh.positions.front();
    Eigen::Vector3f upper = lower;
    for (const Eigen::Vector3f& position : mesh.positions) {
        lower = lower.cwiseMin(position);
        upper = upper.cwiseMax(position);
    }
    Bounds bounds{lower.cast<double>(), upper.cast<double>(), 0.0};
    for (const Eigen::Vector3f& position : mesh.positions) {
        bounds.radius = std::max(bounds.radius, (position.cast<double>() - bounds.centre()).norm());
    }
    return bounds;
}

void validate(const TriangleMesh& mesh, const std::string& name) {
    if (mesh.triangles.empty() || mesh.positions.empty()) {
        throw InputError(fmt::format("{}: the mesh has no triangles", name));
    }
    const std::size_t count = mesh.positions.size();
    if (mesh.normals.size() != count || (!mesh.uv.empty() && mesh.uv.size() != count)) {
        throw InputError(fmt::format("{}: {} positions, {} normals, {} texture coordinates", name,
                                     count, mesh.normals.size(), mesh.uv.size()));
    }
    for (std::size_t i = 0; i < count; ++i) {
        if (!mesh.positions[i].allFinite() || !mesh.normals[i].allFinite()) {
            throw InputError(fmt::format("{}: vertex {} is not finite", name, i + 1));
        }
    }
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        for (const std::uint32_t corner : mesh.triangles[t]) {
            if (corner >= count) {
                throw InputError(fmt::format("{}: triangle {} uses vertex {} of {}", name, t + 1,
                                             corner + 1, count));
            }
        }
    }
    if (!(bounds_of(mesh).radius > 0.0)) {
        throw InputError(fmt::format("{}: the mesh has no extent", name));
    }
}

}  // namespace miebrdf::render
