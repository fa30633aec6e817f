#include "pipeline/render/mesh.h"

#include <Eigen/Geometry>
#include <cmath>
#include <limits>

#include <miebrdf/error.h>
#include "tests/support/catch.h"
#include "tests/support/temporary_folder.h"

using namespace miebrdf;
using namespace miebrdf::render;

namespace {

constexpr char kCube[] =
    "v -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1\nv -1 -1 1\nv 1 -1 1\nv 1 1 1\nv -1 1 1\n"
    "f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";

/// Volume inside a closed mesh by the divergence theorem; positive when faces look outwards.
double volume_of(const TriangleMesh& mesh) {
    double volume = 0.0;
    for (const auto& t : mesh.triangles) {
        const auto p = [&](int c) {
            return Eigen::Vector3d(mesh.positions[t[std::size_t(c)]].cast<double>());
        };
        volume += p(0).dot(p(1).cross(p(2))) / 6;
    }
    return volume;
}

}  // namespace

TEST_CASE("an OBJ cube has twelve triangles, sharp edges and outward faces", "[render][mesh]") {
    const support::TemporaryFolder folder;
    const TriangleMesh cube = read_obj(folder.write("cube.obj", kCube));
    CHECK(cube.triangles.size() == 12);
    CHECK(cube.positions.size() == 24);  // three normals at each of eight corners
    CHECK(volume_of(cube) == Approx(8.0));
    for (const auto& normal : cube.normals) CHECK(normal.cwiseAbs().maxCoeff() == Approx(1.0));
}

TEST_CASE("a finely faceted OBJ is smoothed", "[render][mesh]") {
    // Two faces that meet at 20 degrees share one normal along their edge.
    const support::TemporaryFolder folder;
    const TriangleMesh roof = read_obj(folder.write(
        "roof.obj", "v 0 0 0\nv 0 1 0\nv -1 0 -0.176327\nv 1 0 -0.176327\nf 1 2 3\nf 2 1 4\n"));
    REQUIRE(roof.positions.size() == 4);
    for (std::size_t i = 0; i < 4; ++i) {
        if (std::abs(roof.positions[i].x()) < 0.5F) CHECK(roof.normals[i].z() == Approx(1.0));
    }
}

TEST_CASE("bundled objects have the surface that their formula says", "[render][mesh]") {
    const TriangleMesh knot = make_knot();
    validate(knot, "knot");
    // Volume of a tube: pi r^2 times the length of the centre line (Pappus), here summed from the
    // mesh's own rings.
    const std::size_t ring = 960 / 8 + 1;
    double length = 0.0;
    Eigen::Vector3d last = Eigen::Vector3d::Zero();
    for (std::size_t j = 0; j <= 960; ++j) {
        const std::size_t i = j * ring;
        const Eigen::Vector3d centre =
            (knot.positions[i].cast<double>() + knot.positions[i + ring / 2].cast<double>()) / 2;
        if (j > 0) length += (centre - last).norm();
        last = centre;
    }
    // Polygons in place of circles: 120 sides lose 5e-4 of the area.
    CHECK(volume_of(knot) == Approx(M_PI * 0.3 * 0.3 * length).epsilon(1e-3));

    const Bounds plaque = bounds_of(make_plaque());
    CHECK((plaque.upper - plaque.lower).x() == Approx(2.0));
    CHECK((plaque.upper - plaque.lower).y() == Approx(1.0));
}

TEST_CASE("bad meshes are refused with their name and what is wrong", "[render][mesh][errors]") {
    const support::TemporaryFolder folder;
    const auto reading = [&](const std::string& text) {
        return read_obj(folder.write("bad.obj", text));
    };
    CHECK_THROWS_WITH(read_obj(folder / "missing.obj"),
                      Catch::Contains("missing.obj: no such file"));
    CHECK_THROWS_AS(read_obj(folder / "missing.obj"), InputError);
    for (const char* number : {"nan", "inf", "x", ""}) {
        CHECK_THROWS_WITH(reading("v 0 0 0\nv 1 0 " + std::string(number) + "\nv 0 1 0\nf 1 2 3\n"),
                          Catch::Contains("bad.obj line 2"));
    }
    CHECK_THROWS_WITH(reading(""), Catch::Contains("bad.obj") && Catch::Contains("no triangles"));
    CHECK_THROWS_WITH(reading("v 0 0 0\nv 1 0 0\n"), Catch::Contains("no triangles"));
    CHECK_THROWS_AS(reading("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n"), InputError);
    for (const char* face :
         {"1 2", "", "1 2 x", "1 2 99999999999999999999", "1 2 3.5", "1 2 0x3"}) {
        CHECK_THROWS_WITH(reading("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf " + std::string(face)),
                          Catch::Contains("bad.obj line 5"));
    }
    CHECK(reading("v 0 0 0\r\nv 1 0 0\r\nv 0 1 0\r\nf 1 2 -1\r\n").triangles.size() == 1);
    CHECK_THROWS_WITH(reading("v 1 1 1\nv 1 1 1\nv 1 1 1\nf 1 2 3\n"),
                      Catch::Contains("no extent"));
    TriangleMesh plaque = make_plaque();
    plaque.positions[7].y() = std::numeric_limits<float>::quiet_NaN();
    CHECK_THROWS_WITH(validate(plaque, "plaque"),
                      Catch::Contains("plaque: vertex 8 is not finite"));
}
