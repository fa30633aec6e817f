// Files that pictures come from and go to, masks, maps of light.
#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <numbers>

#include <miebrdf/error.h>
#include "pipeline/render/environment.h"
#include "pipeline/render/image.h"
#include "pipeline/render/material_map.h"
#include "pipeline/render/mesh.h"
#include "tests/support/catch.h"
#include "tests/support/temporary_folder.h"

using namespace miebrdf;
using namespace miebrdf::render;

namespace {

Image ramp(int width, int height, int channels) {
    Image image(width, height, channels);
    for (std::size_t i = 0; i < image.values.size(); ++i)
        image.values[i] = float(i) / float(image.values.size());
    return image;
}

Hit hit_at(double x, double y, double u = 0.0, double v = 0.0) {
    Hit hit;
    hit.position = {x, y, 0.0};
    hit.uv = {u, v};
    return hit;
}

}  // namespace

TEST_CASE("EXR keeps every bit of single precision", "[render][files]") {
    const support::TemporaryFolder folder;
    const Image image = ramp(7, 5, 3);
    write_exr(image, {"R", "G", "B"}, {{"command", "test"}}, folder / "a.exr");
    const Image back = read_exr(folder / "a.exr");
    CHECK(back.width == 7);
    CHECK(back.height == 5);
    CHECK(back.values == image.values);
    CHECK(folder.count() == 1);  // no temporary file stays behind
}

TEST_CASE("PNG stores the sRGB transfer function of IEC 61966-2-1", "[render][files]") {
    const support::TemporaryFolder folder;
    Image grey(3, 1, 3);
    // 0.2140 is the linear value of 8-bit code 127.5 +- rounding; black and white are themselves.
    grey.values = {0, 0, 0, 0.21404F, 0.21404F, 0.21404F, 1.5F, 1.5F, 1.5F};
    write_png(grey, {{"Comment", "test"}}, folder / "a.png");
    const Image back = read_grey_png(folder / "a.png");
    CHECK(back.values[0] == 0.0F);
    CHECK(back.values[1] * 255 == Approx(128).margin(1.0));
    CHECK(back.values[2] == 1.0F);
    CHECK(support::read_file(folder / "a.png").find("test") != std::string::npos);
}

TEST_CASE("a Radiance picture is read in both codings", "[render][files]") {
    const support::TemporaryFolder folder;
    const std::string header = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 8\n";
    std::string flat, coded("\x02\x02\x00\x08", 4);
    for (int x = 0; x < 8; ++x) flat += std::string("\x80\x40\x20\x81", 4);
    for (const char value : {'\x80', '\x40', '\x20', '\x81'}) coded += std::string("\x88") + value;
    for (const std::string& pixels : {flat, coded}) {
        const Image image = read_hdr(folder.write("a.hdr", header + pixels));
        REQUIRE(image.width == 8);
        // Mantissa 128.5/256 times 2^(129 - 128).
        CHECK(image.pixel(7, 0)[0] == Approx(128.5 / 128));
        CHECK(image.pixel(7, 0)[1] == Approx(64.5 / 128));
        CHECK(image.pixel(7, 0)[2] == Approx(32.5 / 128));
    }
    CHECK_THROWS_WITH(read_hdr(folder.write("b.hdr", header + "abc")),
                      Catch::Contains("ends early"));
    CHECK_THROWS_WITH(read_hdr(folder.write("c.hdr", "P6\n")), Catch::Contains("#?RADIANCE"));
}

TEST_CASE("files that cannot be read say which and why", "[render][files][errors]") {
    const support::TemporaryFolder folder;
    const std::string text = folder.write("text", "no picture");
    CHECK_THROWS_WITH(read_grey_png(folder / "missing"), Catch::Contains("missing: no such file"));
    CHECK_THROWS_WITH(read_exr(folder / "missing"), Catch::Contains("missing: no such file"));
    CHECK_THROWS_WITH(read_hdr(folder / "missing"), Catch::Contains("missing: no such file"));
    CHECK_THROWS_AS(read_grey_png(text), InputError);
    CHECK_THROWS_AS(read_exr(text), InputError);
    CHECK_THROWS_AS(write_png(ramp(1, 1, 3), {}, folder / "no/such/folder.png"), InputError);
}

TEST_CASE("a split plane and a mask give each place its material", "[render][regions]") {
    const RayScene plaque = RayScene::mesh(make_plaque(), "plaque");
    const MaterialMap split = MaterialMap::split(0.25, plaque.bounds());
    CHECK(split.material_at(hit_at(-0.51, 0)) == 0);
    CHECK(split.material_at(hit_at(-0.49, 0)) == 1);

    Image levels(4, 2, 1);
    levels.values = {0.0F, 0.5F, 1.0F, 0.0F, 0.0F, 0.0F, 0.0F, 1.0F};
    const MaterialMap mask = MaterialMap::mask(levels, 3, MaskProjection::front, plaque, "mask");
    CHECK(mask.material_at(hit_at(-0.9, 0.4)) == 0);
    CHECK(mask.material_at(hit_at(-0.1, 0.4)) == 1);
    CHECK(mask.material_at(hit_at(0.1, 0.4)) == 2);
    CHECK(mask.material_at(hit_at(0.9, -0.4)) == 2);
    CHECK(mask.material_at(hit_at(0.9, 0.4)) == 0);
    const MaterialMap by_uv = MaterialMap::mask(levels, 3, MaskProjection::uv, plaque, "mask");
    CHECK(by_uv.material_at(hit_at(0, 0, 0.9, 0.1)) == 2);
}

TEST_CASE("a mask of another shape is refused", "[render][regions][errors]") {
    const RayScene plaque = RayScene::mesh(make_plaque(), "plaque");
    const RayScene sphere = RayScene::sphere(Eigen::Vector3d::Zero(), 1.0);
    CHECK_THROWS_WITH(
        MaterialMap::mask(ramp(100, 80, 1), 2, MaskProjection::front, plaque, "logo.png"),
        Catch::Contains("logo.png") && Catch::Contains("100 x 80") && Catch::Contains("50 high"));
    CHECK_THROWS_WITH(
        MaterialMap::mask(ramp(100, 80, 1), 2, MaskProjection::uv, sphere, "logo.png"),
        Catch::Contains("no texture coordinates"));
}

TEST_CASE("a map of light is refused with the pixel that is wrong", "[render][lights][errors]") {
    const std::array<Spectrum, 3> basis{Spectrum{1.0}, {1.0}, {1.0}};
    Image map = ramp(8, 4, 3);
    map.pixel(5, 2)[1] = std::numeric_limits<float>::quiet_NaN();
    CHECK_THROWS_WITH(Environment::from_map(map, basis, "sky.exr"),
                      Catch::Contains("sky.exr: pixel (5, 2) is nan"));
    map.pixel(5, 2)[1] = -1.0F;
    CHECK_THROWS_AS(Environment::from_map(map, basis, "sky.exr"), InputError);
    CHECK_THROWS_WITH(Environment::from_map(ramp(8, 8, 3), basis, "sky.exr"),
                      Catch::Contains("8 x 8") && Catch::Contains("twice as wide"));
}

TEST_CASE("directions drawn from a map have the density that it states", "[render][lights]") {
    // Monte Carlo integral of 1/density over drawn directions is the solid angle of the sphere.
    const Image sky = clear_sky_map(direction_from_angles(30, 20), 1.0, 0.3);
    const auto environment = Environment::from_map(sky, {Spectrum{1.0}, {1.0}, {1.0}}, "sky");
    REQUIRE(environment.has_density());
    double sum = 0.0;
    constexpr int kSide = 400;
    for (int i = 0; i < kSide; ++i) {
        for (int j = 0; j < kSide; ++j) {
            const auto s = environment.sample({(i + 0.5) / kSide, (j + 0.5) / kSide});
            REQUIRE(s.direction.norm() == Approx(1.0));
            CHECK(environment.density(s.direction) == s.density);
            sum += 1 / s.density;
        }
    }
    // Midpoint rule over cells that straddle pixels of different brightness.
    CHECK(sum / (kSide * kSide) == Approx(4 * std::numbers::pi).epsilon(2e-3));
}

TEST_CASE("the clear sky lights level ground as it was asked to", "[render][lights]") {
    const Eigen::Vector3d sun = direction_from_angles(50, 30);
    const Image sky = clear_sky_map(sun, 2.0, 0.0);
    const auto environment = Environment::from_map(sky, {Spectrum{1.0}, {1.0}, {1.0}}, "sky");
    double irradiance = 0.0;
    std::array<double, 1> value{};
    constexpr int kSteps = 300;
    for (int i = 0; i < kSteps; ++i) {
        for (int j = 0; j < kSteps; ++j) {
            const double cos2 = (i + 0.5) / kSteps;  // equal steps of cos^2 carry equal cosines
            const double azimuth = 360.0 * j / kSteps;
            const double elevation = std::asin(std::sqrt(cos2)) * 180 / std::numbers::pi;
            environment.radiance(direction_from_angles(elevation, azimuth), value);
            irradiance += value[0] * std::numbers::pi / (kSteps * kSteps);
        }
    }
    CHECK(irradiance == Approx(2.0).epsilon(2e-3));  // bilinear interpolation over the horizon
}
