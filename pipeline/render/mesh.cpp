#include "pipeline/render/mesh.h"

#include <fmt/format.h>
#include <miebrdf/error.h>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

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

namespace {

using Eigen::Vector3d;

constexpr double kTubeRadius = 0.3;

/// Position on the knot's centre line and its first two derivatives.
struct CurvePoint {
    Vector3d position;
    Vector3d velocity;
    Vector3d acceleration;
};

CurvePoint knot_curve(double t) {
    const double c2 = std::cos(2 * t), s2 = std::sin(2 * t);
    const double c3 = std::cos(3 * t), s3 = std::sin(3 * t);
    const double r = 2 + c3, dr = -3 * s3, ddr = -9 * c3;
    CurvePoint p;
    p.position = Vector3d(r * c2, r * s2, 1.5 * s3) / 3;
    p.velocity = Vector3d(dr * c2 - 2 * r * s2, dr * s2 + 2 * r * c2, 4.5 * c3) / 3;
    p.acceleration = Vector3d(ddr * c2 - 4 * dr * s2 - 4 * r * c2,
                              ddr * s2 + 4 * dr * c2 - 4 * r * s2, -13.5 * s3) /
                     3;
    return p;
}

/// Appends a vertex.
void add(TriangleMesh& mesh, const Vector3d& position, const Vector3d& normal, double u, double v) {
    mesh.positions.push_back(position.cast<float>());
    mesh.normals.push_back(normal.cast<float>());
    mesh.uv.emplace_back(float(u), float(v));
}

/// Triangles of a grid of (columns + 1) x (rows + 1) vertices, row by row; counter-clockwise seen
/// from where columns run right and rows run up.
void connect_grid(TriangleMesh& mesh, int columns, int rows) {
    const auto vertex = [&](int i, int j) { return std::uint32_t(j * (columns + 1) + i); };
    for (int j = 0; j < rows; ++j) {
        for (int i = 0; i < columns; ++i) {
            mesh.triangles.push_back({vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1)});
            mesh.triangles.push_back({vertex(i, j), vertex(i + 1, j + 1), vertex(i, j + 1)});
        }
    }
}

}  // namespace

TriangleMesh make_knot(int segments) {
    TriangleMesh mesh;
    const int around = std::max(3, segments / 8);
    for (int j = 0; j <= segments; ++j) {
        const double v = double(j) / segments;
        const CurvePoint p = knot_curve(2 * std::numbers::pi * v);
        // Frenet's frame: the curvature of this curve vanishes nowhere.
        const Vector3d tangent = p.velocity.normalized();
        const Vector3d binormal = p.velocity.cross(p.acceleration).normalized();
        const Vector3d outward = tangent.cross(binormal);
        for (int i = 0; i <= around; ++i) {
            const double u = double(i) / around;
            const double angle = 2 * std::numbers::pi * u;
            const Vector3d normal = std::cos(angle) * binormal + std::sin(angle) * outward;
            add(mesh, p.position + kTubeRadius * normal, normal, u, v);
        }
    }
    connect_grid(mesh, around, segments);
    return mesh;
}

TriangleMesh make_plaque(double bulge, int segments) {
    TriangleMesh mesh;
    for (int j = 0; j <= 1; ++j) {
        for (int i = 0; i <= segments; ++i) {
            const double u = double(i) / segments;
            const double x = 2 * u - 1;
            const Vector3d position(x, j - 0.5, bulge * (1 - x * x));
            add(mesh, position, Vector3d(2 * bulge * x, 0, 1).normalized(), u, j);
        }
    }
    connect_grid(mesh, segments, 1);
    return mesh;
}

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

}  // namespace

double SphereObject::distance_along(const Ray& ray) const {
    const Eigen::Vector3d to_centre = centre - ray.origin;
    const double middle = to_centre.dot(ray.direction);
    const bool is_outside = to_centre.squaredNorm() > radius * radius;
    if (is_outside && middle <= 0.0) return kInfinity;  // what a convex body sends away is gone
    // From the ray's nearest point to the centre, which loses fewer digits at a distance than the
    // textbook's discriminant (Haines et al. 2019, Ray Tracing Gems, ch. 7).
    const double nearest2 = (to_centre - middle * ray.direction).squaredNorm();
    if (!(nearest2 < radius * radius)) return kInfinity;
    const double half_chord = std::sqrt(radius * radius - nearest2);
    return is_outside ? middle - half_chord : middle + half_chord;
}

std::optional<Hit> SphereObject::intersect(const Ray& ray) const {
    const double distance = distance_along(ray);
    if (!(distance < kInfinity)) return std::nullopt;
    Hit hit;
    hit.normal = (ray.origin + distance * ray.direction - centre) / radius;
    hit.normal.normalize();
    hit.facet_normal = hit.normal;
    hit.position = centre + radius * hit.normal;
    hit.uv.setZero();
    return hit;
}

}  // namespace miebrdf::render
