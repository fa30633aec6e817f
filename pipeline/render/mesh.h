// Triangle meshes: what they are, when they are refused, and how they get normals.
#pragma once

#include <Eigen/Core>

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace miebrdf::render {

struct Ray {
    Eigen::Vector3d origin;
    Eigen::Vector3d direction;  ///< unit
};

struct Hit {
    Eigen::Vector3d position;      ///< on the surface
    Eigen::Vector3d normal;        ///< of the surface as it is shaded, unit, on the side of the ray
    Eigen::Vector3d facet_normal;  ///< of the triangle (or sphere), unit, on the side of the ray
    Eigen::Vector2d uv;            ///< texture coordinates; 0 for objects without
};

struct TriangleMesh {
    std::vector<Eigen::Vector3f> positions;
    std::vector<Eigen::Vector3f> normals;  ///< unit, one for each position
    std::vector<Eigen::Vector2f> uv;       ///< texture coordinates; empty, or one for each position
    std::vector<std::array<std::uint32_t, 3>> triangles;  ///< counter-clockwise seen from outside
};

/// Axis-aligned box around an object, and the smallest sphere around it with the same centre.
struct Bounds {
    Eigen::Vector3d lower;
    Eigen::Vector3d upper;
    double radius = 0.0;
    Eigen::Vector3d centre() const { return 0.5 * (lower + upper); }
};

Bounds bounds_of(const TriangleMesh& mesh);

/// Refuses a mesh without triangles, with numbers that are not finite, without extent, with
/// indices beyond its positions, or with lists of different lengths.
/// @param name  of the object, for the message
/// @throws InputError
void validate(const TriangleMesh& mesh, const std::string& name);

// Bundled objects, made by formula.

/// A trefoil knot of round tube: curved both ways everywhere, and it shadows itself.
/// Centre line ((2 + cos 3t) cos 2t, (2 + cos 3t) sin 2t, 1.5 sin 3t) / 3, tube radius 0.3, exact
/// normals.
/// @param segments  along the knot; an eighth of them around the tube
TriangleMesh make_knot(int segments = 960);

/// A plaque 2 wide and 1 high in the plane of x and y, bulging towards +z by `bulge` in its
/// middle as part of a parabolic cylinder upright: for pictures and text laid on a material.
TriangleMesh make_plaque(double bulge = 0.3, int segments = 400);

/// A sphere for rays to meet, in closed form.
struct SphereObject {
    Eigen::Vector3d centre;
    double radius;

    /// Distance along a ray to its first point on the sphere, infinite where there is none.
    double distance_along(const Ray& ray) const;
    /// The first point itself; its normal looks outwards.
    std::optional<Hit> intersect(const Ray& ray) const;
};

/// Reads all faces of a Wavefront OBJ file, polygons split into triangles; materials are ignored.
/// Without normals in the file, corners are smoothed over neighbouring faces that turn by less than
/// 40 degrees, and sharper edges stay sharp.
/// @throws InputError  when the file is missing, no OBJ, or holds no valid mesh (validate)
TriangleMesh read_obj(const std::string& path);

}  // namespace miebrdf::render
