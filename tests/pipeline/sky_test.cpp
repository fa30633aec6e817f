// Reflectance factors under skies that are not uniform.
#include <miebrdf/brdf.h>
#include <miebrdf/error.h>
#include <miebrdf/value_derivatives.h>

#include <cmath>
#include <numbers>
#include <string>

#include "tests/support/catch.h"
#include "tests/support/scenes.h"
#include "tests/support/temporary_folder.h"

using namespace miebrdf;
using std::numbers::pi;

namespace {

/// A table of one radiance at these zenith and azimuth angles.
std::string flat_sky() {
    std::string text = "zenith_deg,azimuth_deg,radiance\n";
    for (const int zenith : {0, 30, 60, 90})
        for (const int azimuth : {0, 90, 180})
            text += std::to_string(zenith) + "," + std::to_string(azimuth) + ",7.5\n";
    return text;
}

}  // namespace

TEST_CASE("the skies of the CIE have its luminances", "[pipeline][sky]") {
    // Overcast: horizon to zenith 1 : 3, horizontal illuminance 7 pi / 9 of the zenith's.
    const Sky overcast = sky("cie-overcast");
    CHECK(overcast.radiance(1e-12, 0, 0.5, 550) == Approx(1.0 / 3).epsilon(1e-11));
    const int n = 1000;
    double sum = 0.0;
    for (int i = 0; i < n; ++i) {
        const double mu = (i + 0.5) / n;
        sum += 2 * pi * mu / n * overcast.radiance(mu, 40, 0.5, 550);
    }
    CHECK(std::abs(sum / (7 * pi / 9) - 1) <= 1e-6);  // of midpoints
    // Clear: the zenith is 1; the sun's point at 60 degrees by the standard's formula on paper.
    const Sky clear = sky("cie-clear");
    CHECK(clear.radiance(1.0, 0, 0.5, 550) == Approx(1.0).epsilon(1e-13));
    CHECK(clear.radiance(0.5, 0, 0.5, 550) == Approx(13.4805).epsilon(1e-4));
    CHECK(clear.radiance(0.5, 180, 0.5, 550) < 0.2 * clear.radiance(0.5, 0, 0.5, 550));
}

TEST_CASE("a Lambertian ground has its albedo under every sky of a table or the CIE",
          "[pipeline][sky]") {
    Scene ground;
    ground.substrate = substrate("lambert:0.4");
    const char* const name = GENERATE("uniform", "cie-clear", "cie-overcast");
    const double share = GENERATE(0.0, 0.3, 1.0);
    const HdrfValues values =
        solve(ground, {550}).hdrf({{0.5, 1}, {0.3, 1}, {0, 120}}, share, sky(name));
    CHECK(values.converged());
    REQUIRE(values.hdrf[0].size() == 8);
    for (const double factor : values.hdrf[0]) CHECK(std::abs(factor - 0.4) <= 1e-10);
}

TEST_CASE("a table of one radiance is the uniform sky", "[pipeline][sky]") {
    const support::TemporaryFolder folder;
    Scene scene;
    scene.base = medium("hg:0.95,0.6");
    if (GENERATE(false, true)) {  // whose mirror shows the sky
        scene.base.host = host("index:1.4");
        scene.boundary = boundary("smooth");
    }
    const Brdf brdf = solve(scene, {550});
    const Directions directions{{0.5}, {0.3, 0.9}, {0, 70, 180}};
    const HdrfValues table = brdf.hdrf(directions, 0.6, sky(folder.write("sky.csv", flat_sky())));
    const HdrfValues uniform = brdf.hdrf(directions, 0.6);  // by the plane albedo
    CAPTURE(table.summary());
    CHECK(table.converged());
    for (std::size_t i = 0; i < 6; ++i)
        CHECK(table.hdrf[0][i] == Approx(uniform.hdrf[0][i]).epsilon(1e-3));
}

TEST_CASE("of a sky, the glory of large spheres is little", "[pipeline][sky]") {
    const support::TemporaryFolder folder;
    const Brdf brdf = solve(support::scene_of("index:1.31,1e-6,radius=20,variance=0.2"), {550});
    const Directions mirror_side{{0.5}, {0.5}, {0}};
    const HdrfValues table = brdf.hdrf(mirror_side, 0.3, sky(folder.write("sky.csv", flat_sky())));
    const HdrfValues uniform = brdf.hdrf(mirror_side, 0.3);  // by reciprocity, an albedo
    CHECK(table.error_estimate() <= brdf.evaluate({{0.5}, {0.5}, {180}}).error_estimate());
    CHECK(std::abs(table.hdrf[0][0] / uniform.hdrf[0][0] - 1) <=
          table.error_estimate() + uniform.error_estimate());
}

TEST_CASE("derivatives under a sky of one radiance are those of the uniform sky",
          "[pipeline][sky][derivatives]") {
    const support::TemporaryFolder folder;
    Scene scene;
    say(scene, "base", {"hg:{w=0.95},{g=0.6}"});
    const Brdf brdf = solve(scene, {550}, {.tolerance = 1e-3, .streams = 16});
    const Directions directions{{0.5}, {0.3, 0.9}, {0, 180}};
    const Sky table = sky(folder.write("sky.csv", flat_sky()));
    const auto by_table = hdrf_derivatives(brdf, {"w", "g"}, directions, 0.6, table);
    const auto uniform = hdrf_derivatives(brdf, {"w", "g"}, directions, 0.6);  // by the albedo
    for (std::size_t p = 0; p < 2; ++p) {
        for (std::size_t i = 0; i < 4; ++i)
            CHECK(by_table.derivatives[p].hdrf[0][i] ==
                  Approx(uniform.derivatives[p].hdrf[0][i]).epsilon(2e-3));
    }
    CHECK(by_table.values.hdrf[0] == brdf.hdrf(directions, 0.6, table).hdrf[0]);
}

TEST_CASE("light from one ring of the sky is that of a sun there, from all sides",
          "[pipeline][sky]") {
    // Radiance from 40 to 44 degrees of zenith angle: between are those of 42 within its width.
    const support::TemporaryFolder folder;
    std::string text = "zenith_deg,azimuth_deg,radiance\n";
    for (const auto& [zenith, radiance] : {std::pair(0, 0), {32, 0}, {42, 1}, {52, 0}, {90, 0}})
        text += std::to_string(zenith) + ",0," + std::to_string(radiance) + "\n";
    Scene scene;
    scene.base = medium("hg:0.9,0.3");
    const Brdf brdf = solve(scene, {550}, {.tolerance = 1e-2});
    const HdrfValues ring = brdf.hdrf({{0.5}, {0.8}, {0}}, 1.0, sky(folder.write("r.csv", text)));
    const int turns = 12;
    double mean = 0.0;
    for (int k = 0; k < turns; ++k)
        mean +=
            pi / turns *
            brdf.evaluate({{std::cos(42 * pi / 180)}, {0.8}, {360.0 * k / turns}}).at(0, 0, 0, 0);
    CHECK(ring.hdrf[0][0] == Approx(mean).epsilon(1e-2));
}

TEST_CASE("skies that cannot be are refused", "[pipeline][sky][errors]") {
    const support::TemporaryFolder folder;
    CHECK_THROWS_WITH(sky("blue"), Catch::Contains("cie-clear"));
    CHECK_THROWS_AS(sky("blue.csv"), InputError);
    const auto refuses = [&](const std::string& text, const char* reason) {
        CHECK_THROWS_WITH(sky(folder.write("bad.csv", text)), Catch::Contains(reason));
    };
    refuses("zenith_deg,azimuth_deg,radiance\n0,0,1\n95,0,1\n", "zenith_deg 95");
    refuses("zenith_deg,azimuth_deg,radiance\n0,0,1\n50,90,1\n", "expected 4");
    refuses("zenith_deg,azimuth_deg,radiance\n0,0,0\n", "dark");
    refuses("zenith_deg,radiance\n0,1\n", "azimuth_deg");
    const Sky spectral = sky(folder.write(
        "s.csv", "zenith_deg,azimuth_deg,wavelength_nm,radiance\n0,0,400,1\n0,0,500,2\n"));
    CHECK(spectral.radiance(0.5, 0, 0.5, 450) == Approx(1.5));
    CHECK_THROWS_WITH(spectral.radiance(0.5, 0, 0.5, 550), Catch::Contains("400 to 500"));
}
