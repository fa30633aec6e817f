// BrdfTable: solved once, evaluated anywhere.
#include <miebrdf/brdf.h>
#include <miebrdf/error.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <string>

#include "pipeline/solve/parallel.h"
#include "pipeline/solve/solved_table.h"
#include "tests/support/catch.h"
#include "tests/support/scenes.h"

using namespace miebrdf;
using support::random_directions;
using support::scene_of;
using support::under_surface;
using support::values_at;

namespace {

/// Largest difference of a table from Brdf::evaluate, which solves at each direction itself,
/// relative to the largest BRDF at that incidence, as the tolerance is defined.
double largest_difference(const Brdf& brdf, const BrdfTable& table,
                          const std::vector<Direction>& directions) {
    double largest = 0.0;
    for (const Direction& d : directions) {
        const BrdfValues expected =
            brdf.evaluate({{d.mu_in}, {d.mu_out, 0.05, 1.0}, {d.azimuth_deg, 0.0, 180.0}});
        const std::vector<double> found = values_at(table, d);
        for (std::size_t w = 0; w < found.size(); ++w) {
            const std::vector<double>& total = expected.slices[w].total;
            const double scale = *std::max_element(total.begin(), total.end());
            largest = std::max(largest, std::abs(found[w] - total[0]) / scale);
        }
    }
    return largest;
}

}  // namespace

TEST_CASE("a table and values at each direction agree within the tolerance and on converging",
          "[pipeline][table]") {
    Scene rough = under_surface(scene_of("hg:0.9,0.4"), 0.3, 1.5);
    rough.coupling = rte::SurfaceCoupling::reciprocal;
    const std::vector<Scene> scenes = {
        rough, scene_of("index:1.7,0.02,radius=1", {"index:1.4,0.001,radius=0.5@0.3"}),
        scene_of("hg:0.95,0.7", {"rayleigh:0.6@0.5", "isotropic:0.8@0.2"})};
    const Scene& scene = scenes[GENERATE(0U, 1U, 2U)];
    const double tolerance = GENERATE(1e-3, 1e-4);
    const Brdf brdf = solve(scene, {500, 600}, {.tolerance = tolerance});
    const BrdfTable table = brdf.table();
    CAPTURE(describe(scene), tolerance, table.report().error_estimate());
    // Each is within the tolerance of the truth.
    CHECK(largest_difference(brdf, table, random_directions(8, 0.1)) <= 2 * tolerance);
    CHECK(table.report().converged());
    CHECK(brdf.evaluate(support::few_directions()).converged());
    CHECK(brdf.report().converged());
}

TEST_CASE("where streams are too few, a table says so as values do", "[pipeline][table]") {
    const Scene scene = GENERATE(scene_of("hg:0.9,0.95"), scene_of("hg:0.9,0.3", {"hg:1,0.95@2"}),
                                 under_surface(scene_of("hg:0.9,0.95"), 0.3, 1.5));
    const Brdf brdf = solve(scene, {500, 600}, {.streams = 4});
    CAPTURE(describe(scene));
    const BrdfTable table = brdf.table();
    const ResultReport at_probes = brdf.report();
    CHECK_FALSE(table.report().converged());
    CHECK_FALSE(at_probes.converged());
    CHECK(table.report().error_estimate() == Approx(at_probes.error_estimate()).epsilon(1e-6));
    CHECK(table.report().error_estimate() > 1e-3);
    const double share = table.report().worst().solver.share_within_tolerance;
    CHECK(share > 0.0);
    CHECK(share < 1.0);
    // Forward scattering along the horizon is what four streams see least of.
    CHECK(table.report().worst().solver.worst_mu_in == 0.05);
    CHECK(table.report().worst().solver.worst_azimuth_deg == 0.0);
    CHECK_THAT(table.report().summary(), Catch::Contains("mu_in 0.05") &&
                                             Catch::Contains("azimuth 0 ") &&
                                             Catch::Contains("% of the directions"));
    CHECK(table.provenance().accuracy == table.report().summary());
}

TEST_CASE("what Mie theory leaves open is left open by a table, too", "[pipeline][table]") {
    // Exports gave the whole tolerance to the streams once and called this converged.
    Scene scene = scene_of("index:1.5,0,radius=5");
    scene.particles.tolerance = 1e-2;  // ten times the tolerance of the whole
    const Brdf brdf = solve(scene, {550});
    const BrdfTable table = brdf.table();
    CHECK(table.report().wavelengths[0].mie_error_estimate > 1e-3);
    CHECK_FALSE(table.report().converged());
    CHECK_FALSE(brdf.evaluate(support::few_directions()).converged());
}

TEST_CASE("between its cosines a table is as good as its solution", "[pipeline][table]") {
    Scene scene = scene_of("hg:0.9,0.4");
    SECTION("half-space") {}
    SECTION("coat") { scene.layers = {layer("hg:0.6,0.2@0.1")}; }
    SECTION("rough surface, reciprocal coupling") {
        scene = under_surface(scene, 0.3, 1.5);
        scene.coupling = rte::SurfaceCoupling::reciprocal;
    }
    const Brdf brdf = solve(scene, {500, 600}, {.tolerance = 1e-5});
    const BrdfTable table = brdf.table({.command_line = "test"});
    CHECK(table.report().converged());
    CHECK(table.provenance().command_line == "test");
    // Both solve to 1e-5; interpolation between the cosines must not add to that by an order.
    CHECK(largest_difference(brdf, table, random_directions(12, 0.01, 3)) <= 1e-4);
}

TEST_CASE("at the horizon itself the BRDF of large spheres is that just above it",
          "[pipeline][table]") {
    // Fourier files have a row there. The table of glories ends at mu = 0.001: asked for 1e-9 it
    // gave 1e7 per steradian.
    const BrdfTable table = solve(scene_of("index:2.6,0,radius=5"), {550}).table();
    for (const double azimuth : {0.0, 90.0, 165.0, 180.0}) {
        const double horizon = values_at(table, {0.2, 1e-9, azimuth})[0];
        const double above = values_at(table, {0.2, 2e-3, azimuth})[0];
        CAPTURE(azimuth, horizon, above);
        CHECK(std::abs(horizon / above - 1) <= 0.2);
    }
}

TEST_CASE("the number of threads changes no bit of a table", "[pipeline][table]") {
    std::vector<double> wavelength_nm = {500, 600};
    for (int w = 0; w < 18; ++w) wavelength_nm.push_back(610 + 10 * w);  // two sharp parts
    const Scene scene = scene_of("hg:0.9,0.4", {"hg:0.6,0.2@0.1"});
    const std::vector<Direction> directions = random_directions(50, 0.01, 4);
    std::vector<std::vector<double>> values;
    for (const int threads : {1, 2, 7}) {
        const Control control{.threads = threads};
        const BrdfTable table = solve(scene, wavelength_nm, {.tolerance = 1e-5}, control).table();
        values.push_back(evaluate_all(table, directions, "test", control));
    }
    CHECK(values[0] == values[1]);
    CHECK(values[0] == values[2]);
}

TEST_CASE("a table's parts add up: total is the surface and what it lets through",
          "[pipeline][table]") {
    const Brdf brdf =
        solve(under_surface(scene_of("hg:0.9,0.4"), 0.3, 2.0), {500, 600}, {.tolerance = 1e-5});
    const Direction direction{0.6, 0.6, 0.0};
    const auto value = [&](BrdfPart part) {
        return values_at(brdf.table({.part = part}), direction)[0];
    };
    const double share =
        (value(BrdfPart::total) - value(BrdfPart::surface)) / value(BrdfPart::subsurface);
    CHECK(share > 0.8);  // 1 - rho of n = 2 is near 0.89
    CHECK(share < 0.95);
    const BrdfValues values = brdf.evaluate({{0.6}, {0.6}, {0.0}});
    // The lobe is a formula; layers are solved twice.
    CHECK(value(BrdfPart::surface) ==
          Approx(values.at(0, 0, 0, 0, BrdfPart::surface)).epsilon(1e-14));
    CHECK(value(BrdfPart::subsurface) ==
          Approx(values.at(0, 0, 0, 0, BrdfPart::subsurface)).epsilon(2e-5));
}

TEST_CASE("colours of a table are the weighted sums of its wavelengths", "[pipeline][table]") {
    const BrdfTable table =
        solve(under_surface(scene_of("index:1.6,0.02,radius=0.5"), 0.4), {450, 550, 650}).table();
    const ColourWeights weights = {{0.1, 0.0, 0.9}, {0.0, 0.0, 0.0}, {0.8, 0.2, 0.0}};
    const auto mix = table.mix(weights);
    for (const Direction& d : random_directions(20, 0.02)) {
        const std::vector<double> spectrum = values_at(table, d);
        std::array<double, 3> mixed;
        mix->evaluate({&d, 1}, mixed);
        for (std::size_t c = 0; c < 3; ++c) {
            double expected = 0.0;
            for (std::size_t w = 0; w < 3; ++w) expected += weights[w][c] * spectrum[w];
            // Smooth parts are mixed, and rounded to single precision, before they are summed:
            // sixteen roundings of 6e-8.
            CHECK(mixed[c] == Approx(expected).epsilon(1e-6));
        }
    }
}

TEST_CASE("a table for many directions is the exact one within a tenth of the tolerance",
          "[pipeline][table]") {
    Scene pigment = scene_of("Fe2O3,radius=0.2,volume=15% in index:1.5");
    pigment.boundary = rte::Boundary{};
    Scene film = scene_of("isotropic:0.9", {"hg:0.9,0.6 in index:1.3@0.4"});
    film.boundary = rte::Boundary{};
    const bool is_film = GENERATE(false, true);
    const double tolerance = 1e-3;
    const BrdfTable exact =
        solve(is_film ? film : pigment, {450, 600}, {.tolerance = tolerance}).table();
    const BrdfTable fast = for_many_directions(exact, {});
    CAPTURE(is_film);
    // The series have taken light scattered once.
    REQUIRE(fast.solved().sharp.front().is_empty());
    const ColourWeights weights = {{0.1, 0.0, 0.9}, {0.8, 0.2, 0.0}};
    const auto mix = fast.mix(weights);
    for (const double mu_in : {3e-4, 2e-3, 0.02, 0.17, 0.5, 0.83, 1.0}) {
        double largest = 0.0, difference = 0.0, of_mix = 0.0;
        for (const double mu_out : {1e-3, 0.03, 0.21, 0.47, 0.8, 0.99}) {
            for (const double azimuth_deg : {0.0, 7.0, 61.0, 118.0, 173.0, 180.0}) {
                const Direction d{mu_in, mu_out, azimuth_deg};
                const std::vector<double> expected = values_at(exact, d),
                                          found = values_at(fast, d);
                std::array<double, 3> mixed;
                mix->evaluate({&d, 1}, mixed);
                const double mix_off = std::abs(mixed[2] - 0.9 * found[0]);
                if (!(mix_off <= of_mix)) of_mix = mix_off;
                for (std::size_t w = 0; w < found.size(); ++w) {
                    largest = std::max(largest, expected[w]);
                    const double off = std::abs(found[w] - expected[w]);
                    if (!(off <= difference)) difference = off;
                }
            }
        }
        CAPTURE(mu_in);
        CHECK(difference <= 0.1 * tolerance * largest);
        CHECK(of_mix <= 1e-6 * largest);  // sixteen roundings to single precision
    }
}

TEST_CASE("rainbows of a table for many directions stay exact", "[pipeline][table]") {
    const BrdfTable exact = solve(scene_of("index:1.33,1e-3,radius=20"), {550}).table();
    const BrdfTable fast = for_many_directions(exact, {});
    REQUIRE(!fast.solved().sharp.front().is_empty());
    for (const Direction& d : random_directions(20, 0.02))
        CHECK(values_at(fast, d)[0] == Approx(values_at(exact, d)[0]).epsilon(1e-12));
}

TEST_CASE("layers that do not show are not computed for a table either", "[pipeline][table]") {
    support::Stages stages;
    const std::vector<double> wavelength_nm = {500, 600};
    const std::string base = "index:1.5,0,radius=1";
    SECTION("under a deep coat") {
        const Brdf brdf =
            solve(scene_of(base, {"hg:0.3,0.1@60"}), wavelength_nm, {}, stages.control());
        const BrdfTable table = brdf.table();
        CHECK(stages.jobs["single scattering"] == 1);   // the coat, at every wavelength the same
        CHECK(table.provenance().sources.size() == 2);  // the scene is still what was asked for
        // What lies below light that is lost after 60 optical depths cannot matter.
        const BrdfTable black =
            solve(scene_of("isotropic:0", {"hg:0.3,0.1@60"}), wavelength_nm).table();
        for (const Direction& d : random_directions(30, 0.01, 9))
            CHECK(std::abs(values_at(table, d)[0] / values_at(black, d)[0] - 1) <= 2e-3);
    }
    SECTION("under the surface alone") {
        solve(under_surface(scene_of(base)), wavelength_nm, {}, stages.control())
            .table({.part = BrdfPart::surface});
        CHECK(stages.jobs.count("single scattering") == 0);
    }
    SECTION("but what shows is") {
        solve(scene_of(base, {"hg:0.3,0.1@0.5"}), wavelength_nm, {}, stages.control()).table();
        CHECK(stages.jobs["single scattering"] == 3);
    }
    SECTION("and nothing at all where nothing scatters") {
        const BrdfTable black = solve(scene_of("isotropic:0"), wavelength_nm).table();
        CHECK(values_at(black, {0.5, 0.5, 0}) == std::vector{0.0, 0.0});
        CHECK(black.report().converged());
    }
}

TEST_CASE("a surface that is not there has no table", "[pipeline][table][errors]") {
    CHECK_THROWS_WITH(solve(scene_of("hg:0.9,0.4"), {550}).table({.part = BrdfPart::surface}),
                      Catch::Contains("surface") && !Catch::Contains("--"));
}

TEST_CASE("copies of a table outlive the BRDF that made them", "[pipeline][table]") {
    std::optional<BrdfTable> copy;
    double expected = 0.0;
    {
        const Brdf brdf = solve(scene_of("hg:0.9,0.4", {"rayleigh:0.5@0.1"}), {550});
        const BrdfTable table = brdf.table();
        expected = values_at(table, {0.3, 0.4, 50})[0];
        copy = table;
    }
    CHECK(values_at(*copy, {0.3, 0.4, 50})[0] == expected);
}

TEST_CASE("a table refuses directions that are none and values that do not fit",
          "[pipeline][table][errors]") {
    // NaN equals no cosine, so that a loop over directions that share theirs never ended once; a
    // span too short was written beyond its end.
    const BrdfTable table =
        solve(scene_of("hg:0.9,0.4"), {500, 600}, {.stokes = 3}).table({.whole_matrix = true});
    REQUIRE(table.components() == 3);
    const auto mix = table.mix({{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}});
    const double nan = std::nan(""), inf = std::numeric_limits<double>::infinity();
    const auto refuses = [&](const Direction& wrong, const std::string& field) {
        const std::vector<Direction> directions = {{0.5, 0.5, 10.0}, wrong, {0.5, 0.5, 20.0}};
        std::vector<double> values(3 * 2), mixed(3 * 3), matrices(3 * 2 * 9);
        CAPTURE(wrong.mu_in, wrong.mu_out, wrong.azimuth_deg);
        CHECK_THROWS_WITH(table.evaluate(directions, values), Catch::Contains(field));
        CHECK_THROWS_WITH(mix->evaluate(directions, mixed), Catch::Contains(field));
        CHECK_THROWS_WITH(table.evaluate_mueller(directions, matrices), Catch::Contains(field));
        CHECK_THROWS_AS(evaluate_all(table, directions, "test", {}), UsageError);
    };
    for (const double mu : {nan, 0.0, -0.5, 1.01, inf}) {
        refuses({mu, 0.5, 0.0}, "mu_in");
        refuses({0.5, mu, 0.0}, "mu_out");
    }
    for (const double azimuth : {nan, inf, -inf}) refuses({0.5, 0.5, azimuth}, "azimuth_deg");

    const std::vector<Direction> three(3, {0.5, 0.4, 30.0});
    std::vector<double> memory(100, -7.0);
    const std::span<double> all = memory;
    CHECK_THROWS_WITH(table.evaluate(three, all.first(5)), Catch::Contains("room for 6"));
    CHECK_THROWS_WITH(mix->evaluate(three, all.first(8)), Catch::Contains("room for 9"));
    CHECK_THROWS_WITH(table.evaluate_mueller(three, all.first(53)), Catch::Contains("room for 54"));
    CHECK(std::all_of(memory.begin(), memory.end(), [](double v) { return v == -7.0; }));
    CHECK_THROWS_WITH(table.mix({{1.0, 0.0, 0.0}}), Catch::Contains("one for each channel"));
    CHECK(count_sharing_cosines(std::vector<Direction>(2, {nan, 0.5, 0.0})) == 1);
    CHECK(count_sharing_cosines({}) == 0);
}

TEST_CASE("unit vectors in single precision may be longer than 1", "[pipeline][table]") {
    const BrdfTable table = solve(scene_of("hg:0.9,0.4", {"rayleigh:0.5@0.1"}), {550}).table();
    const double beyond = 1.0 + 1e-7;
    CHECK(values_at(table, {beyond, 0.4, 50}) == values_at(table, {1.0, 0.4, 50}));
    CHECK(values_at(table, {0.4, beyond, 50}) == values_at(table, {0.4, 1.0, 50}));
}
