// pbsdf: Mueller matrices for Mitsuba 3's `measured_polarized`.
#include <cmath>
#include <numbers>

#include <miebrdf/brdf.h>
#include "pipeline/formats/common/tensor_reader.h"
#include "tests/support/catch.h"
#include "tests/support/polarising_material.h"
#include "tests/support/scenes.h"
#include "tests/support/written_file.h"

using namespace miebrdf;
using std::numbers::pi;

namespace {

constexpr int kSide = 8;  // intervals of 90 degrees
const ExportOptions kSmall{.resolution = kSide};

/// M of a file at node indices.
class Nodes {
  public:
    explicit Nodes(const std::string& content, std::size_t wavelengths)
        : values_(tensor_floats(read_tensor_file(content), "M")), wavelengths_(wavelengths) {}

    double at(int phi_d, int theta_d, int theta_h, std::size_t wavelength, int row,
              int column) const {
        const auto node = (std::size_t(phi_d) * (kSide + 1) + std::size_t(theta_d)) * (kSide + 1) +
                          std::size_t(theta_h);
        return values_[((node * wavelengths_ + wavelength) * 4 + std::size_t(row)) * 4 +
                       std::size_t(column)];
    }

  private:
    RealView<float> values_;
    std::size_t wavelengths_;
};

/// The two rays of a node, from Rusinkiewicz's definition: the half vector in the x-z plane, the
/// light's turned away from it by theta_d towards phi_d.
struct NodeRays {
    Eigen::Vector3d light, eye;

    NodeRays(int phi_index, int d_index, int h_index) {
        const double phi = pi * (phi_index - kSide) / kSide, d = pi / 2 * d_index / kSide,
                     h = pi / 2 * h_index / kSide;
        const Eigen::Vector3d half(std::sin(h), 0, std::cos(h));
        const Eigen::Vector3d x(std::cos(h), 0, -std::sin(h)), y(0, 1, 0);
        const Eigen::Vector3d off = std::sin(d) * (std::cos(phi) * x + std::sin(phi) * y);
        light = std::cos(d) * half + off;
        eye = std::cos(d) * half - off;
    }
    /// By more than a quarter of a step: lower ones hold the matrix of that height.
    bool above_horizon() const { return light.z() > 0.05 && eye.z() > 0.05; }
};

template <typename Look>
void for_each_node(const Look& look) {
    for (int p = 0; p <= 2 * kSide; ++p)
        for (int d = 0; d <= kSide; ++d)
            for (int h = 0; h <= kSide; ++h) look(p, d, h);
}

}  // namespace

TEST_CASE("pbsdf has the fields, shapes and types that Mitsuba asks for", "[formats][pbsdf]") {
    const support::PolarisingMaterial material({450, 550, 650}, 4, 0.5);
    const std::string content = support::written_file("pbsdf", material, kSmall);
    const auto fields = read_tensor_file(content);
    using Shape = std::vector<std::uint64_t>;
    CHECK(fields.at("M").shape == Shape{2 * kSide + 1, kSide + 1, kSide + 1, 3, 4, 4});
    CHECK(fields.at("phi_d").shape == Shape{1, 2 * kSide + 1});
    CHECK(fields.at("theta_d").shape == Shape{1, kSide + 1});
    CHECK(fields.at("theta_h").shape == Shape{1, kSide + 1});
    CHECK(fields.at("wvls").shape == Shape{3});
    for (const char* name : {"M", "phi_d", "theta_d", "theta_h"})
        CHECK(fields.at(name).type == kTensorFloat);
    CHECK(fields.at("wvls").type == kTensorShort);
    CHECK(fields.at("wvls").bytes == std::string_view("\xc2\x01\x26\x02\x8a\x02", 6));
    const RealView<float> phi = tensor_floats(fields, "phi_d");
    CHECK(phi[0] == Approx(-pi));
    CHECK(phi[2 * kSide] == Approx(pi));
}

TEST_CASE("light scattered once has the scattering matrix in the axes of a pbsdf file",
          "[formats][pbsdf]") {
    // In axes across the plane of both rays, Q changes its sign (across minus along), and the
    // matrix has the pattern of the scattering matrix: any wrong turn fills its zeros.
    const support::PolarisingMaterial material({550}, 4, 0.0);
    const std::string content = support::written_file("pbsdf", material, kSmall);
    const Nodes nodes(content, 1);
    int looked_at = 0;
    for_each_node([&](int p, int d, int h) {
        const NodeRays rays(p, d, h);
        if (!rays.above_horizon()) return;
        ++looked_at;
        const rte::ScatteringMatrix F = support::some_matrix(-rays.light.dot(rays.eye));
        Eigen::Matrix4d expected = Eigen::Matrix4d::Zero();
        expected(0, 0) = F.a1, expected(1, 1) = F.a2, expected(2, 2) = F.a3, expected(3, 3) = F.a4;
        expected(0, 1) = expected(1, 0) = -F.b1;
        expected(2, 3) = F.b2, expected(3, 2) = -F.b2;
        // Straight back the matrix of some_matrix has no symmetry to turn with.
        if (d == 0) return;
        CAPTURE(p, d, h);
        for (int e = 0; e < 16; ++e)
            CHECK(nodes.at(p, d, h, 0, e / 4, e % 4) ==
                  Approx(0.1 * expected(e / 4, e % 4)).margin(1e-7));
    });
    CHECK(looked_at > 200);
}

TEST_CASE("a pbsdf file reads back to the matrices that it was made of", "[formats][pbsdf]") {
    const int components = GENERATE(3, 4);
    Scene scene = support::scene_of("rayleigh:0.9", {"index:1.5,0.01,radius=0.1@0.5"});
    const BrdfTable table = solve(scene, {450, 600}, {.stokes = components}).table();
    REQUIRE(table.components() == components);
    const std::string content = support::written_file("pbsdf", table, kSmall);
    const auto file = read_brdf_file(content, "test");
    REQUIRE(file->format() == "pbsdf");
    REQUIRE(file->components() == 4);
    const auto elements = static_cast<std::size_t>(components * components);
    std::vector<double> found(2 * 16), expected(2 * elements), brdf(2);
    for_each_node([&](int p, int d, int h) {
        const NodeRays rays(p, d, h);
        // Where two rays coincide, or one is vertical, several directions are the same.
        if (!rays.above_horizon() || d == 0 || rays.light.z() > 0.9999 || rays.eye.z() > 0.9999)
            return;
        const double cross = rays.light.x() * rays.eye.y() - rays.light.y() * rays.eye.x();
        const double dot = rays.light.x() * rays.eye.x() + rays.light.y() * rays.eye.y();
        const Direction direction{rays.light.z(), rays.eye.z(),
                                  std::atan2(-cross, -dot) * 180 / pi};
        table.evaluate_mueller({&direction, 1}, expected);
        file->evaluate_mueller(direction, found);
        file->evaluate(direction, brdf);
        CAPTURE(components, p, d, h, direction.azimuth_deg);
        for (std::size_t w = 0; w < 2; ++w) {
            const double scale = expected[w * elements];
            CHECK(brdf[w] == Approx(scale).epsilon(2e-5));
            for (int row = 0; row < 4; ++row) {
                for (int column = 0; column < 4; ++column) {
                    const bool known = row < components && column < components;
                    const double truth =
                        known ? expected[w * elements + std::size_t(row * components + column)]
                              : 0.0;
                    // Angles of 32 bits, which the reader divides by the step.
                    CHECK(std::abs(found[16 * w + std::size_t(4 * row + column)] - truth) <=
                          2e-5 * scale);
                }
            }
        }
    });
}

TEST_CASE("a thin gas polarises across the plane of scattering at a right angle",
          "[formats][pbsdf]") {
    Scene scene;
    scene.substrate = substrate("black");
    scene.layers = {layer("rayleigh:1@0.001")};
    const BrdfTable table = solve(scene, {550}, {}).table({.whole_matrix = true});
    CHECK(table.components() == 4);
    const std::string content = support::written_file("pbsdf", table, kSmall);
    const Nodes nodes(content, 1);
    // theta_d 45 degrees: the rays are at a right angle.
    const int d = kSide / 2, h = 0;
    const double I = nodes.at(kSide, d, h, 0, 0, 0);
    CHECK(nodes.at(kSide, d, h, 0, 1, 0) / I == Approx(1.0).epsilon(5e-3));  // of orders above
    CHECK(std::abs(nodes.at(kSide, d, h, 0, 2, 0) / I) <= 1e-6);
    CHECK(std::abs(nodes.at(kSide, d, h, 0, 3, 0) / I) <= 1e-6);
}

TEST_CASE("what does not polarise has one element in a pbsdf file", "[formats][pbsdf]") {
    const auto check = [](const BrdfSource& source) {
        const std::string content = support::written_file("pbsdf", source, kSmall);
        const Nodes nodes(content, 1);
        for_each_node([&](int p, int d, int h) {
            CHECK(nodes.at(p, d, h, 0, 0, 0) > 0.0);
            for (int e = 1; e < 16; ++e)
                CHECK(std::abs(nodes.at(p, d, h, 0, e / 4, e % 4)) <= 1e-7);
        });
    };
    check(solve(support::scene_of("hg:0.9,0.3"), {550}, {.stokes = 4}).table());
    check(support::TestMaterial({550}, 0.3));  // knows its BRDF alone
}

TEST_CASE("pbsdf refuses wavelengths that its reader cannot have", "[formats][pbsdf][errors]") {
    CHECK_THROWS_WITH(support::written_file("pbsdf", support::material(), kSmall),
                      Catch::Contains("7") && Catch::Contains("at most 5"));
    CHECK_THROWS_WITH(support::written_file("pbsdf", support::TestMaterial({550.5}, 0.3), kSmall),
                      Catch::Contains("550.5") && Catch::Contains("whole nanometres"));
}
