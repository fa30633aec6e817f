// Scenes with a refracting boundary: words, hosts that depend on wavelength, tables, cache, plan,
// and what people measure on films of paint.
#include <miebrdf/brdf.h>
#include <miebrdf/error.h>
#include <miebrdf/plan.h>

#include <cmath>
#include <numbers>

#include "pipeline/scene/scene_parts.h"
#include "tests/support/catch.h"
#include "tests/support/reference_table.h"
#include "tests/support/scenes.h"

using namespace miebrdf;
using support::scene_of;

namespace {

Scene behind_boundary(Scene scene, const std::string& host_words = "index:1.5") {
    scene.particles.host = host(host_words);
    scene.boundary = boundary("smooth");
    return scene;
}

Scene on_substrate(const std::string& ground, const std::vector<std::string>& layers) {
    Scene scene;
    scene.substrate = substrate(ground);
    for (const std::string& words : layers) scene.layers.push_back(layer(words));
    return scene;
}

bool has_note(const ResultReport& report, const std::string& part) {
    return std::any_of(report.notes.begin(), report.notes.end(), [&](const std::string& note) {
        return note.find(part) != std::string::npos;
    });
}

}  // namespace

TEST_CASE("boundaries and mirrors are read and described", "[pipeline][boundary]") {
    CHECK(boundary("smooth") == rte::Boundary{});
    CHECK(boundary("rough:0.2").roughness == 0.2);
    CHECK(boundary("rough:0.2,beckmann").distribution == rte::MicrofacetDistribution::beckmann);
    for (const std::string words : {"smooth", "rough:0.2,ggx", "rough:0.05,beckmann"})
        CHECK(describe(boundary(words)) == words);
    for (const std::string bad :
         {"", "matt", "rough", "rough:", "rough:0,phong", "rough:0.001", "rough:1.5", "rough:-1",
          "rough:nan", "rough:0.1,phong", "rough:0.1,ggx,1"})
        CHECK_THROWS_AS(boundary(bad), UsageError);
    CHECK(describe(substrate("mirror:Al")) == "mirror:Al");
    CHECK(describe(substrate("mirror:index:0.96,6.69")) == "mirror:index:0.96,6.69");
    for (const std::string bad : {"mirror:", "mirror", "mirror:index:0,1", "mirror:index:1,-1"})
        CHECK_THROWS_AS(substrate(bad), UsageError);
}

TEST_CASE("a roughness of 0 is smooth, and below a rough boundary there may be air",
          "[pipeline][boundary]") {
    CHECK(boundary("rough:0") == rte::Boundary{});
    CHECK(boundary("rough:0,ggx") == rte::Boundary{});
    Scene scene = scene_of("index:1.6,0.001,radius=0.3 in air");
    const double open = solve(scene, {550}, {.tolerance = 1e-4}).albedo({0.5}).at(0, 0);
    scene.boundary = boundary("rough:0.3");
    const Brdf brdf = solve(scene, {550}, {.tolerance = 1e-4});
    CHECK(has_note(brdf.albedo({0.5}), "taken as smooth"));
    // 2 (n - 1) = 5.6e-4 of the diffuse light comes back inside.
    CHECK(std::abs(brdf.albedo({0.5}).at(0, 0) / open - 1.0) <= 1e-3);
}

TEST_CASE("a scene has a boundary or the paper's lobe", "[pipeline][boundary]") {
    Scene scene = behind_boundary(support::under_surface(scene_of("isotropic:0.9"), 0.3, 1.5));
    CHECK_THROWS_WITH(solve(scene, {550}), Catch::Contains("not both"));
    scene.surface.reset();
    scene.particles.host = host("index:0.9");
    CHECK_THROWS_WITH(solve(scene, {550}), Catch::Contains("1 to 3"));
    scene.particles.host = host("index:1");
    CHECK(has_note(solve(scene, {550}).albedo({1.0}), "changes nothing"));
    // Air between the particles on top, glass below: the boundary lies deeper.
    scene.layers = {layer("isotropic:0.5 in index:1@0.1")};
    scene.base = medium("isotropic:0.9 in index:1.5");
    CHECK_FALSE(has_note(solve(scene, {550}).albedo({1.0}), "changes nothing"));
}

TEST_CASE("layers follow the host's index over wavelength", "[pipeline][boundary]") {
    // PMMA disperses: the mirror's part of an empty film over black is Fresnel's at each
    // wavelength.
    Scene scene = behind_boundary(on_substrate("black", {}), "PMMA");
    const auto values = solve(scene, {450, 550, 650}).albedo({1.0});
    for (std::size_t w = 0; w < 3; ++w) {
        const double r = values.mirror_reflectance[w][0];
        const double n = (1.0 + std::sqrt(r)) / (1.0 - std::sqrt(r));
        CHECK(n > 1.48);
        CHECK(n < 1.51);
        CHECK(std::abs(values.plane_albedo[w][0] - r) <= 1e-12);
    }
    CHECK(values.mirror_reflectance[0][0] > values.mirror_reflectance[2][0]);
}

TEST_CASE("values, tables and albedos of a scene with a boundary agree", "[pipeline][boundary]") {
    Scene scene = behind_boundary(scene_of("hg:0.95,0.5"));
    SECTION("half-space") {}
    SECTION("film on a mirror") {
        scene = behind_boundary(on_substrate("mirror:index:0.96,6.69", {"hg:0.98,0.6@0.5"}));
    }
    SECTION("free film") { scene = behind_boundary(on_substrate("none", {"hg:0.98,0.6@0.5"})); }
    SECTION("two hosts") {
        scene = behind_boundary(scene_of("hg:0.99,0.6 in index:1.7", {"hg:0.9,0.3@0.4"}));
    }
    const auto brdf = solve(scene, {500, 600}, {.tolerance = 1e-4});
    const auto table = brdf.table();
    double largest = 0.0;
    for (const Direction& d : support::random_directions(60, 0.1)) {
        std::vector<double> found(2);
        table.evaluate({&d, 1}, found);
        const auto exact = brdf.evaluate({{d.mu_in}, {d.mu_out}, {d.azimuth_deg}});
        const double error =
            std::abs(found[0] - exact.at(0, 0, 0, 0)) / std::abs(exact.at(0, 0, 0, 0));
        if (!(error <= largest)) largest = error;
    }
    // Two solutions with a tolerance of 1e-4 each, and interpolation between cosines.
    CHECK(largest <= 2e-3);
}

TEST_CASE("the cache tells boundaries and hosts apart", "[pipeline][boundary]") {
    const Scene plain = on_substrate("lambert:0.5", {"hg:0.9,0.3@0.4"});
    const Scene smooth = behind_boundary(plain), denser = behind_boundary(plain, "index:1.6");
    Scene free = plain;
    free.substrate = substrate("none");
    const auto dir = support::few_directions();
    std::vector<double> seen;
    for (const Scene& scene : {plain, smooth, denser, free, behind_boundary(free)})
        seen.push_back(solve(scene, {550}).evaluate(dir).at(0, 1, 1, 0));
    for (std::size_t i = 0; i < seen.size(); ++i) {
        for (std::size_t j = 0; j < i; ++j) CHECK(std::abs(seen[i] - seen[j]) > 1e-3 * seen[i]);
    }
}

TEST_CASE("binder without a boundary gets a note, its surface the binder's index",
          "[pipeline][boundary]") {
    Scene scene =
        on_substrate("black", {"Au,radius=0.03,distribution=mono in index:1.5@0.5[grey]"});
    CHECK(has_note(solve(scene, {550}).albedo({1.0}), "no boundary"));
    scene = support::under_surface(scene);
    const auto values = solve(scene, {550}).evaluate({{1.0}, {1.0}, {0.0}});
    // Normal reflectance .04 of the binder, not of gold: D(0) F / 4 with D(0) = 1 / (pi alpha^2).
    const double lobe = 0.04 / (4.0 * std::numbers::pi * 0.09);
    CHECK(std::abs(values.at(0, 0, 0, 0, BrdfPart::surface) - lobe) <= 1e-3 * lobe);
}

TEST_CASE("plan names the boundary", "[pipeline][boundary]") {
    const auto stages = [](const Scene& scene) {
        std::string text;
        for (const auto& step : plan_albedo(solve(scene, {550}), {1.0}).steps)
            text += step.stage + ";";
        return text;
    };
    CHECK(stages(behind_boundary(scene_of("hg:0.9,0.5"))).find("boundary") != std::string::npos);
    CHECK(plan_albedo(solve(behind_boundary(scene_of("hg:0.9,0.5"), "index:1"), {550}), {1.0})
              .leaves_out("no boundary"));
}

TEST_CASE("Saunderson's correction holds for a base of Kubelka and Munk's kind",
          "[pipeline][boundary]") {
    // A Lambertian base without particles above it: exactly his assumptions but for normal light.
    const double r_ext_normal = 0.04, r_int = 0.5963457597;
    for (const double R : {0.05, 0.495, 0.9}) {
        const Scene scene =
            behind_boundary(on_substrate("lambert:" + std::to_string(R), {}), "index:1.5");
        const double measured =
            solve(scene, {550}, {.streams = 24}).albedo({1.0}).plane_albedo[0][0];
        const double expected =
            r_ext_normal + (1.0 - r_ext_normal) * (1.0 - r_int) * R / (1.0 - r_int * R);
        CHECK(std::abs(measured - expected) <= 1e-8);
    }
}

TEST_CASE("the opaque lobe takes either distribution of slopes", "[pipeline][surface]") {
    CHECK_FALSE(rough_surface("0"));
    CHECK(rough_surface("0.3")->distribution == rte::MicrofacetDistribution::beckmann);
    CHECK(rough_surface("0.3,ggx")->distribution == rte::MicrofacetDistribution::ggx);
    for (const char* text : {"0.3", "0.25,ggx"}) CHECK(describe(*rough_surface(text)) == text);
    for (const char* text : {"", ",ggx", "0.3,phong", "0.3,ggx,1", "-0.1", "2.1", "nan"})
        CHECK_THROWS_AS(rough_surface(text), UsageError);
    // At normal incidence and return D G / (4 mu mu') is 1 / (4 pi alpha^2), whatever the slopes.
    for (const char* text : {"0.3", "0.3,ggx"}) {
        Scene scene;
        scene.base = medium("isotropic:0");
        scene.surface = rough_surface(text);
        scene.surface_index = {1.5, 0.0};
        const auto values = solve(scene, {550}).evaluate({{1.0}, {1.0}, {0.0}});
        const double fresnel = 0.04;  // ((n - 1) / (n + 1))^2
        const double expected = fresnel / (4 * std::numbers::pi * 0.09);
        CHECK(std::abs(values.slices[0].surface[0] - expected) <= 1e-12 * expected);
    }
}
