// Tables of light that polarises: what exports, renderers and plots are made of.
#include <miebrdf/brdf.h>
#include <miebrdf/error.h>

#include <cmath>

#include "pipeline/scene/scene_parts.h"
#include "tests/support/catch.h"
#include "tests/support/scenes.h"

using namespace miebrdf;
using support::random_directions;
using support::scene_of;

namespace {

/// Largest difference of a table's matrices from Brdf::mueller, relative to element 11.
double largest_difference(const Brdf& brdf, const BrdfTable& table,
                          const std::vector<Direction>& directions) {
    const int c = table.components();
    std::vector<double> found(std::size_t(c * c));
    double largest = 0.0;
    for (const Direction& d : directions) {
        const MuellerValues expected = brdf.mueller({{d.mu_in}, {d.mu_out}, {d.azimuth_deg}});
        table.evaluate_mueller({&d, 1}, found);
        for (int row = 0; row < c; ++row) {
            for (int column = 0; column < c; ++column) {
                const double difference =
                    found[std::size_t(row * c + column)] - expected.at(0, 0, 0, 0, row, column);
                largest = std::max(largest, std::abs(difference) / expected.at(0, 0, 0, 0));
            }
        }
    }
    return largest;
}

Scene on_substrate(const std::string& ground, const std::string& film) {
    Scene scene;
    scene.substrate = substrate(ground);
    scene.layers.push_back(layer(film));
    return scene;
}

}  // namespace

TEST_CASE("a table's Mueller matrices are those at each direction",
          "[pipeline][table][polarisation]") {
    const int components = GENERATE(3, 4);
    std::vector<Scene> scenes = {
        scene_of("rayleigh:0.9"),
        scene_of("index:1.5,0.01,radius=0.1", {"rayleigh:1@0.3", "hg:0.9,0.5@0.2"}),
        scene_of("rayleigh:0.8 in index:1.5"),
        scene_of("rayleigh:0.8 in index:1.5", {"rayleigh:1 in index:1.33@0.4"}),
        on_substrate("lambert:0.5", "rayleigh:0.9 in index:1.5@0.3"),
        on_substrate("mirror:index:0.96,6.69", "rayleigh:0.9@0.3")};
    for (std::size_t s = 2; s < 5; ++s) scenes[s].boundary = rte::Boundary{};
    const Scene& scene = scenes[GENERATE(0U, 1U, 2U, 3U, 4U, 5U)];
    const double tolerance = 1e-5;
    const Brdf brdf = solve(scene, {550}, {.tolerance = tolerance, .stokes = components});
    const BrdfTable table = brdf.table();
    CAPTURE(describe(scene), table.report().error_estimate());
    REQUIRE(table.components() == components);
    CHECK(table.report().converged());
    std::vector<Direction> directions = random_directions(6, 0.05);
    directions.push_back({1.0, 0.4, 70.0});  // vertical: the meridian plane is that of the azimuth
    directions.push_back({0.4, 1.0, -70.0});
    directions.push_back({0.6, 0.6, 180.0});  // straight back
    // Each is within the tolerance of the truth; between its cosines the table adds 1e-5.
    CHECK(largest_difference(brdf, table, directions) <= 2 * tolerance + 1e-5);
}

TEST_CASE("where auto finds that polarisation shows, a table holds element 11",
          "[pipeline][table][polarisation]") {
    const Scene scene = scene_of("rayleigh:0.95", {"index:1.5,0,radius=0.05@0.3"});
    const BrdfTable table = solve(scene, {550}, {.tolerance = 1e-4}).table();
    CHECK(table.components() == 1);
    CHECK(table.report().wavelengths[0].stokes == 3);
    CHECK_THAT(table.provenance().polarisation, Catch::Contains("3 components"));
    const Brdf polarised = solve(scene, {550}, {.tolerance = 1e-4, .stokes = 3});
    const BrdfTable scalar = solve(scene, {550}, {.tolerance = 1e-4, .stokes = 1}).table();
    CHECK(scalar.report().wavelengths[0].stokes == 1);
    double largest_change = 0.0;
    for (const Direction& d : random_directions(8, 0.1)) {
        const double m11 =
            polarised.mueller({{d.mu_in}, {d.mu_out}, {d.azimuth_deg}}).at(0, 0, 0, 0);
        const double value = support::values_at(table, d)[0];
        CHECK(value == Approx(m11).epsilon(4e-4));  // both within the tolerance of the brightest
        // Without a whole matrix the only element is the BRDF.
        double element = 0.0;
        table.evaluate_mueller({&d, 1}, {&element, 1});
        CHECK(element == value);
        largest_change =
            std::max(largest_change, std::abs(support::values_at(scalar, d)[0] / value - 1));
    }
    CHECK(largest_change > 0.01);  // what a table of the scalar solution would leave out
}

TEST_CASE("what a boundary does to light on its way is in element 11 of a table",
          "[pipeline][table][polarisation][boundary]") {
    Scene scene = scene_of("rayleigh:0.5 in index:1.6");
    scene.boundary = rte::Boundary{};
    const BrdfTable polarised = solve(scene, {550}, {.tolerance = 1e-5, .stokes = 3}).table();
    const BrdfTable scalar = solve(scene, {550}, {.tolerance = 1e-5, .stokes = 1}).table();
    CHECK(polarised.components() == 3);
    // Light that comes in and leaves flat: both passages and the particle polarise across.
    const Direction flat{0.2, 0.2, 90.0};
    const double change =
        support::values_at(polarised, flat)[0] / support::values_at(scalar, flat)[0] - 1.0;
    CHECK(std::abs(change) > 0.01);
    double matrix[9];
    polarised.evaluate_mueller({&flat, 1}, matrix);
    CHECK(matrix[0] == Approx(support::values_at(polarised, flat)[0]).epsilon(1e-13));  // rounding
}

TEST_CASE("a table of what does not polarise is the scalar one",
          "[pipeline][table][polarisation]") {
    const std::string words = GENERATE(as<std::string>(), "hg:0.9,0.5", "index:1.5,0,radius=5");
    const BrdfTable automatic = solve(scene_of(words), {550}, {.stokes = 0}).table();
    const BrdfTable scalar = solve(scene_of(words), {550}, {.stokes = 1}).table();
    CHECK(automatic.report().wavelengths[0].stokes == 1);
    for (const Direction& d : random_directions(5, 0.1))
        CHECK(support::values_at(automatic, d) == support::values_at(scalar, d));
}

TEST_CASE("a table asked for its whole matrix has four components unless 1 is asked for",
          "[pipeline][table][polarisation]") {
    const Scene scene = scene_of("rayleigh:0.5");
    CHECK(solve(scene, {550}).table({.whole_matrix = true}).components() == 4);
    CHECK(solve(scene, {550}, {.stokes = 3}).table({.whole_matrix = true}).components() == 3);
    CHECK(solve(scene, {550}, {.stokes = 1}).table({.whole_matrix = true}).components() == 1);
    const Scene rough = support::under_surface(scene, 0.3, 1.5);
    CHECK_THROWS_WITH(solve(rough, {550}).table({.whole_matrix = true}),
                      Catch::Contains("surface"));
    const ResultReport left_out = solve(rough, {550}).table().report();
    CHECK(left_out.wavelengths[0].polarisation_left_out > 0.0);
    const BrdfTable lobe = solve(rough, {550}).table({.part = BrdfPart::surface});
    CHECK(lobe.components() == 1);
}
