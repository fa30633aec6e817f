// Natural grounds: published code, albedos of MODIS, cdisort's layers on them, energy.
#include <miebrdf/brdf.h>
#include <miebrdf/error.h>

#include <cmath>
#include <numbers>
#include <string>

#include "tests/support/catch.h"
#include "tests/support/reference_table.h"

using namespace miebrdf;
using support::ReferenceTable;

namespace {

Substrate ground_of(std::string words) {
    for (char& c : words)
        if (c == ' ') c = ',';
    return substrate(words);
}

double cos_of_degrees(double angle) { return std::cos(angle * (std::numbers::pi / 180.0)); }

}  // namespace

TEST_CASE("BRDFs of grounds are those of published code", "[pipeline][ground]") {
    const ReferenceTable table("rte/ground_brdfs.csv");
    REQUIRE(table.size() == 1392);
    double worst = 0.0;
    for (std::size_t row = 0; row < table.size(); ++row) {
        const double expected = table.number(row, "reflection");
        const double found =
            ground_of(table.text(row, "ground"))
                .brdf.reflection(table.number(row, "mu_in"), table.number(row, "mu_out"),
                                 cos_of_degrees(table.number(row, "azimuth_deg")));
        // Ross-Li goes through 0.
        const double error = std::abs(found - expected) / std::max(0.01, std::abs(expected));
        worst = std::max(worst, error);
    }
    CHECK(worst <= 1e-10);
}

TEST_CASE("in retro-reflection a ground's hot spot is at its height", "[pipeline][ground]") {
    const double mu = GENERATE(0.2, 0.7, 1.0);
    const double k = 0.8, theta = -0.1, rho0 = 0.1;
    const double M = std::pow(2 * mu * mu * mu, k - 1);
    const double F = (1 - theta * theta) / std::pow(1 + theta, 3);
    CHECK(substrate("rpv:0.1,0.8,-0.1").brdf.reflection(mu, mu, -1.0) ==
          Approx(rho0 * M * F * (2 - rho0)).epsilon(1e-13));
    // Hapke without roughness: P (1 + B0) of light scattered once.
    const auto once = [&](const char* words) {
        return substrate(words).brdf.reflection(mu, mu, -1);
    };
    const double P = 0.7 * (1 - 0.09) / std::pow(0.7, 3) + 0.3 * (1 - 0.09) / std::pow(1.3, 3);
    CHECK(once("hapke:0.5,0.3,0.4,1.5,0.07,0") - once("hapke:0.5,0.3,0.4,0,0.07,0") ==
          Approx(0.5 / (8 * mu) * P * 1.5).epsilon(1e-13));
}

TEST_CASE("white-sky albedos of Ross-Li grounds are those of the MODIS product",
          "[pipeline][ground]") {
    // Lucht, Schaaf & Strahler 2000, table I: integrals of the kernels, 6 digits.
    Scene bare;
    bare.substrate = substrate("ross-li:0.3,0.1,0.02");
    const auto values = solve(bare, {550}, {.tolerance = 1e-5}).albedo({0.5});
    CHECK(std::abs(values.spherical_albedo[0] - (0.3 + 0.1 * 0.189184 - 0.02 * 1.377622)) <= 3e-6);
    // Black-sky albedo at 60 degrees by the product's polynomials (table I), good to 1 %.
    const double t = std::numbers::pi / 3;
    const double vol = -0.007574 - 0.070987 * t * t + 0.307588 * t * t * t;
    const double geo = -1.284909 - 0.166314 * t * t + 0.041840 * t * t * t;
    CHECK(std::abs(values.at(0, 0) - (0.3 + 0.1 * vol + 0.02 * geo)) <= 2e-3);
}

TEST_CASE("layers on a ground by its BRDF are those of cdisort", "[pipeline][ground]") {
    const ReferenceTable table("rte/ground_layers.csv");
    for (std::size_t row = 0; row < table.size(); ++row) {
        Scene scene;
        scene.substrate = ground_of(table.text(row, "ground"));
        scene.layers = {layer("hg:" + table.text(row, "albedo") + "," + table.text(row, "g") + "@" +
                              table.text(row, "depth"))};
        const Brdf brdf = solve(scene, {550}, {.tolerance = 1e-5});
        const double mu_in = table.number(row, "mu_in");
        const BrdfValues values = brdf.evaluate(
            {{mu_in}, {table.number(row, "mu_out")}, {table.number(row, "azimuth_deg")}});
        CAPTURE(row, values.summary());
        CHECK(values.converged());
        // The table changes by 2e-5 from 32 to 48 streams, and may err by half of that.
        CHECK(std::numbers::pi * values.at(0, 0, 0, 0) ==
              Approx(table.number(row, "reflection")).epsilon(2e-5));
        const AlbedoValues albedo = brdf.albedo({mu_in});
        CHECK(std::abs(albedo.at(0, 0) - table.number(row, "plane_albedo")) <= 3e-6);
        CHECK(std::abs(albedo.plane_transmittance[0][0] - table.number(row, "transmittance")) <=
              3e-6);
    }
}

TEST_CASE("light that a ground by its BRDF does not return is in it", "[pipeline][ground]") {
    const char* const ground =
        GENERATE("rpv:0.1,0.8,-0.1", "ross-li:0.3,0.1,0.02", "hapke:0.6,0.3,0.2,0.8,0.06,20");
    const int stokes = GENERATE(1, 3);
    Scene scene;
    scene.substrate = substrate(ground);
    scene.layers = {layer("hg:1,0.6@0.7"), layer("rayleigh:1@0.3")};
    const auto values = solve(scene, {550}, {.stokes = stokes}).albedo({0.2, 0.9});
    for (const std::size_t i : {0U, 1U})
        CHECK(std::abs(values.at(0, i) + values.plane_transmittance[0][i] - 1.0) <= 1e-10);
    CHECK(std::abs(values.spherical_albedo[0] + values.spherical_transmittance[0] - 1.0) <= 1e-10);
    // Light goes both ways alike.
    const auto ways =
        solve(scene, {550}, {.stokes = stokes}).evaluate({{0.3, 0.8}, {0.3, 0.8}, {50}});
    CHECK(ways.at(0, 0, 1, 0) == Approx(ways.at(0, 1, 0, 0)).epsilon(1e-10));
}

TEST_CASE("tables of scenes on a ground hold its hot spot", "[pipeline][ground]") {
    Scene scene;
    scene.substrate = substrate("hapke:0.3,0.3,0.4,1.5,0.07,21");
    if (GENERATE(false, true)) scene.layers = {layer("hg:0.9,0.5@0.1")};
    const int stokes = GENERATE(1, 3);
    const Brdf brdf = solve(scene, {450, 550}, {.stokes = stokes});
    const BrdfTable table = brdf.table();
    const auto exact = brdf.evaluate({{0.6}, {0.6, 0.3}, {180, 175, 40}});
    for (std::size_t o = 0; o < 2; ++o) {
        for (std::size_t a = 0; a < 3; ++a) {
            const std::vector<Direction> at{
                {0.6, exact.directions.mu_out[o], exact.directions.azimuth_deg[a]}};
            std::vector<double> values(2);
            table.evaluate(at, values);
            CHECK(values[1] == Approx(exact.at(1, 0, o, a)).epsilon(1e-3));
        }
    }
}

TEST_CASE("derivatives by parameters of a ground are differences", "[pipeline][ground]") {
    const auto scene_of = [](double rho0, double depth) {
        Scene scene;
        say(scene, "substrate", {"rpv:{rho0=" + std::to_string(rho0) + "},0.8,{theta=-0.1}"});
        say(scene, "coat", {"hg:0.9,0.5@{depth=" + std::to_string(depth) + "}"});
        return scene;
    };
    const Directions directions{{0.6}, {0.3, 0.6}, {0, 180}};
    const SolverOptions options{.tolerance = 1e-6};
    const auto at = [&](double rho0, double depth) {
        const Brdf brdf = solve(scene_of(rho0, depth), {550}, options);
        return std::pair(brdf.evaluate(directions), brdf.albedo({0.6}));
    };
    const BrdfDerivatives by =
        solve(scene_of(0.1, 0.5), {550}, options).derivatives({"rho0", "depth"});
    const auto found = by.evaluate(directions);
    const auto albedo = by.albedo({0.6});
    const double step = 1e-3;
    const std::pair<double, double> moves[] = {{step, 0.0}, {0.0, step}};
    for (std::size_t p = 0; p < 2; ++p) {
        const auto [more, more_albedo] = at(0.1 + moves[p].first, 0.5 + moves[p].second);
        const auto [less, less_albedo] = at(0.1 - moves[p].first, 0.5 - moves[p].second);
        const auto slope = [&](double a, double b) { return (a - b) / (2 * step); };
        for (std::size_t o = 0; o < 2; ++o)
            for (std::size_t a = 0; a < 2; ++a)
                CHECK(found.derivatives[p].at(0, 0, o, a) ==
                      Approx(slope(more.at(0, 0, o, a), less.at(0, 0, o, a))).epsilon(2e-3));
        CHECK(albedo.derivatives[p].at(0, 0) ==
              Approx(slope(more_albedo.at(0, 0), less_albedo.at(0, 0))).epsilon(2e-3));
        CHECK(albedo.derivatives[p].plane_transmittance[0][0] ==
              Approx(slope(more_albedo.plane_transmittance[0][0],
                           less_albedo.plane_transmittance[0][0]))
                  .epsilon(2e-3));
    }
}

TEST_CASE("grounds that return more than they get are refused or told of",
          "[pipeline][ground][errors]") {
    CHECK(describe(substrate("rpv:0.1,0.8,-0.1")) == "rpv:0.1,0.8,-0.1,0.1");
    CHECK_THROWS_WITH(substrate("rpv:0.9,0.5,-0.4"), Catch::Contains("uniform light"));
    CHECK_THROWS_WITH(substrate("rpv:0.1,0.8"), Catch::Contains("RHO0,K,THETA[,RHOC]"));
    CHECK_THROWS_WITH(substrate("hapke:1.2,0.3,0,1,0.05,20"),
                      Catch::Contains("w 1.2") && Catch::Contains("0 to 1"));
    CHECK_THROWS_WITH(substrate("grass"), Catch::Contains("ross-li:ISO,VOL,GEO"));
    Scene scene;
    scene.substrate = substrate("rpv:0.3,0.4,-0.2");
    const auto report = solve(scene, {550}).evaluate({{0.5}, {0.5}, {0}});
    REQUIRE(!report.notes.empty());
    CHECK_THAT(report.notes.front(), Catch::Contains("more light than it gets"));
    scene.boundary = boundary("smooth");
    CHECK_THROWS_WITH(solve(scene, {550}), Catch::Contains("in air"));
    scene.boundary.reset();
    scene.layers = {layer("isotropic:1@0.1")};
    CHECK_THROWS_WITH(
        solve(scene, {550}, {.coat_method = rte::CoatMethod::first_order}).albedo({0.5}),
        Catch::Contains("automatic method"));
}
