#include "pipeline/render/mesh.h"

#include <fmt/format.h>

// Compiled here, rather than a library to load at every start.
#define TINYOBJLOADER_IMPLEMENTATION
#include <tiny_obj_loader.h>

#include <Eigen/Geometry>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <tuple>

#include <miebrdf/error.h>

namespace miebrdf::render {
namespace {

/// Edges at which faces turn by more stay sharp.
constexpr float kCosCrease = 0.766F;  // cos 40 degrees

struct Corner {
    int position;
    int normal;  ///< -1: none in the file
    int uv;      ///< -1: none in the file
};
using Face = std::array<Corner, 3>;

Eigen::Vector3f vec3(const std::vector<tinyobj::real_t>& values, int index) {
    const auto at = [&](int k) { return float(values.at(std::size_t(3 * index + k))); };
    return {at(0), at(1), at(2)};
}

std::vector<Face> faces_of(const tinyobj::ObjReader& reader) {
    std::vector<Face> faces;
    for (const tinyobj::shape_t& shape : reader.GetShapes()) {
        const auto& indices = shape.mesh.indices;
        for (std::size_t i = 0; i + 2 < indices.size(); i += 3) {
            Face face;
            for (std::size_t c = 0; c < 3; ++c) {
                const tinyobj::index_t& index = indices[i + c];
                face[c] = {index.vertex_index, index.normal_index, index.texcoord_index};
            }
            faces.push_back(face);
        }
    }
    return faces;
}

/// Cross product of two edges: along the normal, twice the area long.
Eigen::Vector3f area_vector(const Face& face, const tinyobj::attrib_t& attrib) {
    const Eigen::Vector3f a = vec3(attrib.vertices, face[0].position);
    return (vec3(attrib.vertices, face[1].position) - a)
        .cross(vec3(attrib.vertices, face[2].position) - a);
}

/// For each corner the area-weighted mean normal of the faces around its position that are smooth
/// neighbours of its own face.
class SmoothNormals {
  public:
    SmoothNormals(const std::vector<Face>& faces, const tinyobj::attrib_t& attrib)
        : around_(attrib.vertices.size() / 3) {
        for (const Face& face : faces) {
            const Eigen::Vector3f area = area_vector(face, attrib);
            for (const Corner& corner : face)
                around_.at(std::size_t(corner.position)).push_back(area);
        }
    }

    Eigen::Vector3f at(const Corner& corner, const Eigen::Vector3f& own) const {
        Eigen::Vector3f sum = Eigen::Vector3f::Zero();
        for (const Eigen::Vector3f& area : around_[std::size_t(corner.position)]) {
            if (area.dot(own) > kCosCrease * area.norm() * own.norm()) sum += area;
        }
        // A face without area has no direction of its own; any unit vector will do.
        return sum.norm() > 0.0F ? Eigen::Vector3f(sum.normalized()) : Eigen::Vector3f::UnitZ();
    }

  private:
    std::vector<std::vector<Eigen::Vector3f>> around_;
};

/// Makes one vertex of each different combination of position, normal and texture coordinate.
class MeshBuilder {
  public:
    explicit MeshBuilder(const tinyobj::attrib_t& attrib) : attrib_(attrib) {}

    std::uint32_t vertex(const Corner& corner, const Eigen::Vector3f& normal) {
        const auto key =
            std::make_tuple(corner.position, corner.uv, normal.x(), normal.y(), normal.z());
        const auto [found, is_new] = known_.try_emplace(key, std::uint32_t(mesh.positions.size()));
        if (is_new) {
            mesh.positions.push_back(vec3(attrib_.vertices, corner.position));
            mesh.normals.push_back(normal);
            if (!attrib_.texcoords.empty()) mesh.uv.push_back(uv(corner.uv));
        }
        return found->second;
    }

    TriangleMesh mesh;

  private:
    Eigen::Vector2f uv(int index) const {
        if (index < 0) return {0.0F, 0.0F};
        const auto at = [&](int k) {
            return float(attrib_.texcoords.at(std::size_t(2 * index + k)));
        };
        return {at(0), at(1)};
    }

    const tinyobj::attrib_t& attrib_;
    std::map<std::tuple<int, int, float, float, float>, std::uint32_t> known_;
};

void require_finite(const std::vector<tinyobj::real_t>& values, const char* what,
                    const std::string& path) {
    for (std::size_t i = 0; i < values.size(); ++i) {
        if (!std::isfinite(values[i])) {
            throw InputError(fmt::format("{}: {} {} is not finite", path, what, i / 3 + 1));
        }
    }
}

[[noreturn]] void refuse(const std::string& path, int line, const std::string& wanted) {
    throw InputError(fmt::format("{} line {}: {}", path, line, wanted));
}

/// Three corners or more, each an index that fits its type, perhaps with more after a slash.
bool is_face(std::istream& words) {
    std::string corner;
    int corners = 0;
    for (; words >> corner; ++corners) {
        int index = 0;
        const char* const end = corner.data() + corner.size();
        const auto [after, error] = std::from_chars(corner.data(), end, index);
        if (error != std::errc() || (after != end && *after != '/')) return false;
    }
    return corners >= 3;
}

/// tinyobjloader reads what is not a number (nan, text, nothing) as 0 without a word, and leaves
/// out faces of two corners.
void require_numbers(const std::string& path) {
    std::ifstream file(path);
    std::string line, word;
    for (int number = 1; std::getline(file, line); ++number) {
        std::istringstream words(line);
        words >> word;
        if (words && word == "f" && !is_face(words))
            refuse(path, number, "three or more indices of vertices are wanted after 'f'");
        if (!words || (word != "v" && word != "vn")) continue;
        for (int i = 0; i < 3; ++i) {
            double value = 0.0;  // streams do not read "nan" or "inf" as numbers
            if (words >> value) continue;
            refuse(path, number, fmt::format("three finite numbers are wanted after '{}'", word));
        }
    }
}

TriangleMesh build(const std::vector<Face>& faces, const tinyobj::attrib_t& attrib) {
    const SmoothNormals smooth(faces, attrib);
    MeshBuilder builder(attrib);
    for (const Face& face : faces) {
        const Eigen::Vector3f own = area_vector(face, attrib);
        std::array<std::uint32_t, 3> triangle;
        for (std::size_t c = 0; c < 3; ++c) {
            const bool given = face[c].normal >= 0;
            const Eigen::Vector3f normal =
                given ? Eigen::Vector3f(vec3(attrib.normals, face[c].normal).normalized())
                      : smooth.at(face[c], own);
            triangle[c] = builder.vertex(face[c], normal);
        }
        builder.mesh.triangles.push_back(triangle);
    }
    return std::move(builder.mesh);
}

}  // namespace

TriangleMesh read_obj(const std::string& path) {
    if (!std::filesystem::exists(path)) throw InputError(fmt::format("{}: no such file", path));
    if (!std::filesystem::is_regular_file(path))
        throw InputError(fmt::format("{}: no ordinary file", path));
    require_numbers(path);
    tinyobj::ObjReaderConfig config;
    config.triangulate = true;
    tinyobj::ObjReader reader;
    if (!reader.ParseFromFile(path, config)) {
        throw InputError(
            fmt::format("{}: cannot be read as an OBJ file: {}", path, reader.Error()));
    }
    const tinyobj::attrib_t& attrib = reader.GetAttrib();
    require_finite(attrib.vertices, "vertex", path);
    require_finite(attrib.normals, "normal", path);
    const std::vector<Face> faces = faces_of(reader);
    TriangleMesh mesh;
    try {
        mesh = build(faces, attrib);
    } catch (const std::out_of_range&) {
        throw InputError(fmt::format("{}: a face uses a vertex that the file does not have", path));
    }
    validate(mesh, path);
    return mesh;
}

}  // namespace miebrdf::render
