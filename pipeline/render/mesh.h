// Triangle meshes: what they are, when they are refused, and how they get normals.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace miebrdf::render {

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

}  // namespace miebrdf::render
