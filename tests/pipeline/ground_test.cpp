// Layers on grounds and free films: energy, Beer, Kubelka and Munk.
#include <miebrdf/brdf.h>
#include <miebrdf/error.h>

#include <cmath>
#include <numbers>
#include <string>

#include "tests/support/catch.h"
#include "tests/support/temporary_folder.h"

using namespace miebrdf;

TEST_CASE("a purely absorbing film lets through what Beer says", "[pipeline][ground]") {
    Scene film;
    film.substrate = substrate("none");
    film.layers = {layer("isotropic:0@1.5")};
    const auto values = solve(film, {550}).albedo({0.25, 1.0});
    for (std::size_t i = 0; i < 2; ++i) {
        const double truth = std::exp(-1.5 / values.mu_in[i]);
        CHECK(std::abs(values.plane_transmittance[0][i] / truth - 1.0) <= 1e-13);
        CHECK(values.at(0, i) <= 1e-15);
    }
    // Uniform light gives 2 E_3(1.5), Abramowitz & Stegun table 5.4 (E_3 = 0.0567395).
    CHECK(std::abs(values.spherical_transmittance[0] - 2 * 0.0567395) <= 1e-4);
}

TEST_CASE("what is not absorbed comes back or arrives at the ground", "[pipeline][ground]") {
    const double ground = GENERATE(0.0, 0.3, 1.0);
    const std::string depth = GENERATE("0.01", "1", "30", "3000");
    CAPTURE(ground, depth);
    Scene film;
    film.substrate = substrate("lambert:" + std::to_string(ground));
    film.layers = {layer("hg:1,0.8@" + depth), layer("isotropic:1@0.5")};
    const auto values = solve(film, {550}).albedo({0.05, 0.4, 1.0});
    for (std::size_t i = 0; i < 3; ++i)
        CHECK(std::abs(values.at(0, i) + values.plane_transmittance[0][i] - 1) <= 1e-11);
    CHECK(std::abs(values.spherical_albedo[0] + values.spherical_transmittance[0] - 1) <= 1e-11);
}

TEST_CASE("a white ground under nothing that matters is the ground", "[pipeline][ground]") {
    const support::TemporaryFolder folder;
    const std::string file =
        folder.write("soil.csv", "# soil\nwavelength_nm,albedo\n500,0.2\n600,0.4\n");
    Scene film;
    film.substrate = substrate("lambert:" + file);
    film.layers = {layer("isotropic:0@1e-12")};
    const auto values = solve(film, {500, 525, 600}).albedo({0.5});
    CHECK(std::abs(values.at(0, 0) - 0.2) <= 1e-11);
    CHECK(std::abs(values.at(1, 0) - 0.25) <= 1e-11);
    CHECK(std::abs(values.at(2, 0) - 0.4) <= 1e-11);
    CHECK_THROWS_WITH(solve(film, {650}), Catch::Contains("650") && Catch::Contains("500 to 600"));
}

TEST_CASE("grounds that cannot be are refused", "[pipeline][ground][errors]") {
    CHECK(substrate("lambert:80%").albedo == std::vector<double>{0.8});
    CHECK_THROWS_WITH(substrate("lambert:1.2"), Catch::Contains("1.2"));
    CHECK_THROWS_WITH(substrate("lambert:soil.csv"), Catch::Contains("soil.csv"));
    CHECK_THROWS_WITH(substrate("grass"), Catch::Contains("black") && Catch::Contains("is a base"));
    const support::TemporaryFolder folder;
    for (const char* text :
         {"a,b\n500,0.2\n", "wavelength_nm,albedo\n500\n", "",
          "wavelength_nm,albedo\n500,0.2\n500,0.3\n", "wavelength_nm,albedo\n500,1.2\n"}) {
        CHECK_THROWS_AS(substrate("lambert:" + folder.write("x.csv", text)), InputError);
    }
    Scene nothing;
    nothing.substrate = substrate("none");
    CHECK_THROWS_WITH(solve(nothing, {550}), Catch::Contains("coat"));
}

TEST_CASE("a bare ground reflects what it is said to", "[pipeline][ground]") {
    Scene bare;
    bare.substrate = substrate("lambert:0.5");
    const Brdf brdf = solve(bare, {550});
    CHECK(std::abs(brdf.albedo({0.3}).at(0, 0) - 0.5) <= 1e-12);
    CHECK(std::abs(brdf.evaluate({{0.3}, {0.6}, {40}}).at(0, 0, 0, 0) - 0.5 / std::numbers::pi) <=
          1e-12);
}

TEST_CASE("a black ground takes all light, bare or below layers without depth",
          "[pipeline][ground]") {
    Scene scene;
    scene.substrate = substrate(GENERATE("black", "lambert:0", "none"));
    if (scene.substrate->kind == Substrate::Kind::none || GENERATE(false, true))
        scene.layers = {layer("hg:0.5,0.2@0")};
    const int stokes = GENERATE(0, 1, 3);
    const AlbedoValues values = solve(scene, {550}, {.stokes = stokes}).albedo({0.3, 1.0});
    for (const std::size_t i : {0U, 1U}) {
        CHECK(values.plane_albedo[0][i] == 0.0);
        CHECK(values.plane_transmittance[0][i] == 1.0);
    }
    CHECK(values.spherical_transmittance[0] == 1.0);
    CHECK(solve(scene, {550}, {.stokes = stokes}).evaluate({{0.3}, {0.6}, {40}}).at(0, 0, 0, 0) ==
          0.0);
}

TEST_CASE("white films in diffuse light are Kubelka and Munk's", "[pipeline][mixture][ground]") {
    // Thick films that absorb nothing: R = ((1 - G) S h + G) / ((1 - G) S h + 1) over a ground G.
    const double ground = GENERATE(0.0, 0.8);
    const double thickness_um = GENERATE(20.0, 60.0, 200.0);
    CAPTURE(ground, thickness_um);
    Scene film;
    film.substrate = substrate("lambert:" + std::to_string(ground));
    film.layers = {{medium("index:2.75,0,radius=0.13,distribution=gamma,volume=15% in index:1.5"),
                    {Depth::Kind::thickness_um, thickness_um}}};
    const Brdf brdf = solve(film, {550}, {.tolerance = 1e-4});
    const double scattered = (1 - ground) * *brdf.layers().at(0).s_km * thickness_um;
    const double kubelka_munk = (scattered + ground) / (scattered + 1);
    // The boundary layers, in which light is not diffuse, leave this (7e-4 measured at 20 um).
    CHECK(std::abs(brdf.albedo({1.0}).spherical_albedo[0] - kubelka_munk) <= 1e-3);
}
