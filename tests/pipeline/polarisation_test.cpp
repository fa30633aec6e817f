// Light with its polarisation, from words to Mueller matrices.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <numbers>
#include <random>

#include <miebrdf/brdf.h>
#include <miebrdf/error.h>
#include <miebrdf/plan.h>
#include "pipeline/cache/result_cache.h"
#include "pipeline/solve/optics_memo.h"
#include "pipeline/solve/polarisation.h"
#include "pipeline/solve/single_scattering.h"
#include "rte/boundary/fresnel_matrix.h"
#include "rte/phase/polarisation.h"
#include "rte/stack/layered_reflection.h"
#include "tests/support/catch.h"
#include "tests/support/reference_table.h"
#include "tests/support/scenes.h"
#include "tests/support/temporary_folder.h"

using namespace miebrdf;
using support::scene_of;

namespace {

rte::Optics optics_of_words(const std::string& words, double wavelength_nm = 550) {
    const ResolvedScene scene = resolve(scene_of(words), {wavelength_nm});
    OpticsDemand demand;
    demand.polarisation = true;
    return compute_optics(scene, 0, 0, demand).optics;
}

std::string written(const support::TemporaryFolder& folder, const std::string& name,
                    const std::string& text) {
    const std::string path = (folder.path() / name).string();
    std::ofstream(path) << text;
    return path;
}

constexpr char kRayleighRows[] =
    "0,1,0,0,0,0,0\n1,0,0,0,1.5,0,0\n2,0.5,3,0,0,-1.2247448713915890,0\n";

std::string file_of_rayleigh() {
    return std::string("# single_scattering_albedo: 0.9\nl,a1,a2,a3,a4,b1,b2\n") + kRayleighRows;
}

}  // namespace

TEST_CASE("rayleigh takes a depolarisation factor in words", "[pipeline][polarisation]") {
    const rte::Optics air = optics_of_words("rayleigh:0.9,depolarisation=0.0279");
    const double anisotropic = (1 - 0.0279) / (1 + 0.0279 / 2);
    CHECK(air.chi[2] == Approx(0.1 * anisotropic).epsilon(1e-14));
    CHECK(air.polarisation->b1[2] == Approx(-std::sqrt(1.5) * anisotropic).epsilon(1e-14));
    CHECK(describe(medium("rayleigh:0.9,depolarisation=0.0279")) ==
          "rayleigh:0.9,depolarisation=0.0279");
    CHECK(describe(medium("rayleigh:0.9,depolarisation=0")) == "rayleigh:0.9");
    CHECK(medium("rayleigh:0.9,depolarisation=0") == medium("rayleigh:0.9"));
    CHECK_THROWS_WITH(medium("rayleigh:0.9,depolarisation=0.9"),
                      Catch::Contains("0.9") && Catch::Contains("[0, 6/7]"));
    CHECK_THROWS_WITH(medium("rayleigh:0.9,depolarized=0.1"), Catch::Contains("depolarisation"));
    CHECK_THROWS_AS(medium("hg:0.9,0.5,depolarisation=0.1"), UsageError);
}

TEST_CASE("a file of coefficients is read as it is", "[pipeline][polarisation]") {
    const support::TemporaryFolder folder;
    const std::string path = written(folder, "rayleigh.csv", file_of_rayleigh());
    const rte::Optics file = optics_of_words("matrix:" + path);
    const rte::Optics formula = rte::rayleigh_optics(0.9);
    CHECK(file.single_scattering_albedo == 0.9);
    CHECK(file.chi == formula.chi);
    CHECK(file.polarisation->a2 == std::vector<double>{0, 0, 3});
    CHECK(file.polarisation->a4 == std::vector<double>{0, 1.5, 0});
    CHECK(file.polarisation->b1[2] == Approx(formula.polarisation->b1[2]).epsilon(1e-15));
    CHECK(describe(medium("matrix:" + path)) == "matrix:" + path);
}

TEST_CASE("a spectral file of coefficients is linear between its wavelengths",
          "[pipeline][polarisation]") {
    const support::TemporaryFolder folder;
    const std::string path = written(
        folder, "spectral.csv",
        "wavelength_nm,single_scattering_albedo,l,a1,a2,a3,a4,b1,b2\n"
        "400,0.8,0,1,0,0,0,0,0\n400,0.8,1,0.9,0,0,0.1,0,0\n"
        "600,0.6,0,1,0,0,0,0,0\n600,0.6,1,0.3,0,0,0.1,0,0\n600,0.6,2,0.2,1,0.4,0,-0.1,0.04\n");
    const rte::Optics between = optics_of_words("matrix:" + path, 450);
    CHECK(between.single_scattering_albedo == Approx(0.75).epsilon(1e-14));
    CHECK(3 * between.chi[1] == Approx(0.75).epsilon(1e-14));
    CHECK(between.polarisation->b2[2] == Approx(0.01).epsilon(1e-14));
    CHECK_THROWS_WITH(optics_of_words("matrix:" + path, 700),
                      Catch::Contains("700") && Catch::Contains("400 to 600"));
    // Results of one wavelength are not those of another.
    const ResolvedScene scene = resolve(scene_of("matrix:" + path), {450, 500, 450});
    CHECK(scene.media[0].key[0] != scene.media[0].key[1]);
    CHECK(scene.media[0].key[0] == scene.media[0].key[2]);
}

TEST_CASE("files of coefficients that are wrong are refused with their line",
          "[pipeline][polarisation][errors]") {
    const support::TemporaryFolder folder;
    struct Case {
        std::string text, message;
    };
    const std::string head = "# single_scattering_albedo: 0.9\nl,a1,a2,a3,a4,b1,b2\n";
    const auto wrong =
        GENERATE_COPY(Case{"", "no rows"}, Case{head + "1,1,0,0,0,0,0\n", "wrong.csv:3"},
                      Case{head + "0,1,0,0,0,0\n", "6 fields under 7"},
                      Case{head + "0,1,0,0,0,0,0\n2,0,0,0,0,0,0\n", "l = 2; expected 1"},
                      Case{head + "0,0.5,0,0,0,0,0\n", "0.5"},
                      Case{head + "0,1,0,0,0,0,0\n1,nan,0,0,0,0,0\n", "wrong.csv:4"},
                      Case{"l,a1,a2,a3,a4,b1,b2\n0,1,0,0,0,0,0\n", "albedo"},
                      Case{"l,a1,a2,a3,a4,b1\n0,1,0,0,0,0\n", "no column 'b2'"},
                      Case{"l,a1,a2,a3,a4,b1,b2,c9\n0,1,0,0,0,0,0,0\n", "'c9'"},
                      Case{head + "0,1,0,0,0,0,0\n1,0,0,0,0,0,0\n2,0,7,0,0,0,0\n", "7"});
    CAPTURE(wrong.text);
    CHECK_THROWS_WITH(medium("matrix:" + written(folder, "wrong.csv", wrong.text)),
                      Catch::Contains(wrong.message));
    CHECK_THROWS_AS(medium("matrix:/no/such/file.csv"), InputError);
}

TEST_CASE("optics with a scattering matrix come back from the cache whole",
          "[pipeline][polarisation][cache]") {
    OpticsDemand demand;
    demand.polarisation = true;
    const ResolvedScene scene = resolve(scene_of("index:1.6,0.01,radius=0.2"), {500});
    const MediumOptics optics = compute_optics(scene, 0, 0, demand);
    const MediumOptics copy = unpacked_optics(packed(optics));
    REQUIRE(copy.optics.polarisation);
    CHECK(copy.optics.chi == optics.optics.chi);
    CHECK(copy.optics.polarisation->a2 == optics.optics.polarisation->a2);
    CHECK(copy.optics.polarisation->b2 == optics.optics.polarisation->b2);
    OpticsDemand scalar;
    CHECK(optics_hash(scene.media[0].species[0], 0, demand) !=
          optics_hash(scene.media[0].species[0], 0, scalar));
}

TEST_CASE("a mixture polarises as its species by what they scatter", "[pipeline][polarisation]") {
    const rte::Optics a = optics_of_words("index:1.5,0,radius=0.1");
    const rte::Optics b = optics_of_words("index:2,0.1,radius=0.05");
    const rte::Optics both =
        optics_of_words("index:1.5,0,radius=0.1,volume=10% + index:2,0.1,radius=0.05,volume=1%");
    REQUIRE(both.polarisation);
    // One unknown share explains all coefficients.
    const double share = (both.chi[1] - b.chi[1]) / (a.chi[1] - b.chi[1]);
    CHECK(share > 0.0);
    CHECK(share < 1.0);
    for (std::size_t l = 2; l < 6; ++l) {
        const auto& p = *both.polarisation;
        CHECK(p.b1[l] == Approx(share * a.polarisation->b1[l] + (1 - share) * b.polarisation->b1[l])
                             .margin(1e-10));
        CHECK(p.a3[l] == Approx(share * a.polarisation->a3[l] + (1 - share) * b.polarisation->a3[l])
                             .margin(1e-10));
    }
}

TEST_CASE("the Mueller matrix of a Rayleigh half-space is that of the table",
          "[pipeline][polarisation]") {
    const support::ReferenceTable table("rte/stokes_rayleigh_half_space.csv");
    const Brdf brdf = solve(scene_of("rayleigh:0.9"), {550}, {.tolerance = 1e-7, .stokes = 4});
    REQUIRE(table.size() > 10);
    for (std::size_t row = 0; row < table.size(); ++row) {
        const double mu_in = table.number(row, "mu_in"), mu_out = table.number(row, "mu_out");
        const double azimuth = table.number(row, "azimuth_deg");
        const MuellerValues values = brdf.mueller({{mu_in}, {mu_out}, {azimuth}});
        CAPTURE(mu_in, mu_out, azimuth);
        CHECK(values.converged());
        const auto check = [&](int r, int c, const char* name) {
            const double R = std::numbers::pi * values.at(0, 0, 0, 0, r, c);
            CHECK(std::abs(R - table.number(row, name)) <= 1e-7);  // digits, and the tolerance
        };
        check(0, 0, "r11");
        check(1, 0, "r21");
        check(2, 0, "r31");
        check(1, 1, "r22");
        check(2, 2, "r33");
        check(3, 3, "r44");
    }
}

TEST_CASE("light that nothing polarises has the Mueller matrix of its BRDF",
          "[pipeline][polarisation]") {
    const Scene scene = scene_of("hg:0.9,0.5", {"isotropic:0.5@0.3"});
    const Directions directions = support::few_directions();
    const BrdfValues scalar = solve(scene, {550}, {.stokes = 1}).evaluate(directions);
    const MuellerValues matrix = solve(scene, {550}, {.stokes = 3}).mueller(directions);
    for (std::size_t i = 0; i < 2; ++i) {
        for (std::size_t o = 0; o < 2; ++o) {
            for (std::size_t a = 0; a < 3; ++a) {
                CHECK(matrix.at(0, i, o, a) ==
                      Approx(scalar.at(0, i, o, a)).epsilon(2e-3));  // two tolerances
                CHECK(matrix.degree_of_linear_polarisation(0, i, o, a) <= 1e-12);
            }
        }
    }
}

TEST_CASE("auto computes polarisation where it shows, and only there",
          "[pipeline][polarisation][rules]") {
    const Directions directions = {{0.5, 1.0}, {0.5, 1.0}, {0, 180}};
    const auto report = [&](const std::string& words, double tolerance) {
        const Brdf brdf = solve(scene_of(words), {550}, {.tolerance = tolerance, .stokes = 0});
        return brdf.evaluate(directions).wavelengths.front();
    };
    CHECK(report("rayleigh:0.9", 1e-3).stokes == 3);
    CHECK(report("index:1.5,0,radius=0.03", 1e-3).stokes == 3);
    // Smaller spheres tell of larger ones, whose matrices cost too much.
    const WavelengthReport coarse = report("index:1.5,0.01,radius=100", 1e-3);
    CHECK(coarse.stokes == 1);
    CHECK(coarse.polarisation_left_out > 6e-3);
    CHECK(coarse.polarisation_left_out <= 0.05);
    CHECK_FALSE(coarse.converged);
    const WavelengthReport clear = report("index:1.5,0,radius=100", 1e-2);
    CHECK(clear.stokes == 1);
    CHECK(clear.polarisation_left_out > 0.0);
    CHECK(clear.polarisation_left_out <= 1e-2);
    CHECK(clear.solver.converged == clear.converged);
    // Where those matrices are cheap they are computed.
    const Directions grazing = {{0.45}, {0.2, 0.8}, {0, 90, 180}};
    const auto metal = [&](int stokes) {
        return solve(scene_of("index:1.8,0.08,radius=14.5,variance=0.07"), {550},
                     {.tolerance = 3e-3, .stokes = stokes})
            .evaluate(grazing);
    };
    const BrdfValues chosen = metal(0), polarised = metal(3), numbers = metal(1);
    CHECK(chosen.wavelengths[0].stokes == 3);
    CHECK(chosen.slices[0].total == polarised.slices[0].total);
    CHECK(std::abs(chosen.at(0, 0, 0, 2) / numbers.at(0, 0, 0, 2) - 1) > 6e-3);
    // Two surfaces, of which one sees what the other polarised, and none of the particles do.
    Scene film = scene_of("isotropic:1", {"hg:0.5,0 in index:1.5@1e-12"});
    film.substrate = substrate("none");
    film.boundary = rte::Boundary{};
    CHECK(std::abs(solve(film, {550}).albedo({0.5}).plane_albedo[0][0] - 0.15187) <= 2e-5);
    const WavelengthReport none = report("hg:0.9,0.7", 1e-3);
    CHECK(none.stokes == 1);
    CHECK(none.polarisation_left_out == 0.0);
}

TEST_CASE("where auto leaves polarisation out, values are those of light without it",
          "[pipeline][polarisation][rules]") {
    const support::TemporaryFolder folder;
    std::size_t averages = 0;
    const Control control{.threads = 1,
                          .progress =
                              [&](const std::string& stage, std::size_t, std::size_t) {
                                  if (stage == "single scattering") ++averages;
                              },
                          .cache = std::make_shared<ResultCache>(folder / "results.sqlite")};
    const Directions directions = {{0.5, 1.0}, {0.5, 1.0}, {0, 180}};
    const Scene scene = scene_of("index:1.5,0.01,radius=0.3");
    const Brdf brdf = solve(scene, {550, 600}, {.stokes = 0}, control);
    const BrdfValues values = brdf.evaluate(directions);
    CHECK(averages == 4);  // matrices of few sizes, and those that the values are made of
    const BrdfValues numbers = solve(scene, {550, 600}, {.stokes = 1}).evaluate(directions);
    for (std::size_t w = 0; w < 2; ++w) {
        CHECK(values.wavelengths[w].stokes == 1);
        CHECK(values.wavelengths[w].polarisation_left_out > 0.0);
        CHECK(values.slices[w].total == numbers.slices[w].total);
    }
    // The plan knows them, too: other directions take them from the cache.
    const Plan plan = plan_evaluate(brdf, {{0.3}, {0.7}, {90}});
    CHECK(std::none_of(plan.steps.begin(), plan.steps.end(),
                       [](const PlannedStep& step) { return step.stage == "single scattering"; }));
}

TEST_CASE("where matrices take long, those of few sizes tell auto what it may leave out",
          "[pipeline][polarisation][rules]") {
    std::size_t averages = 0;
    const Control control{.threads = 1,
                          .progress = [&](const std::string& stage, std::size_t, std::size_t) {
                              if (stage == "single scattering") ++averages;
                          }};
    const auto values = [&](const Scene& scene, const Directions& directions, int stokes) {
        averages = 0;
        return solve(scene, {550}, {.stokes = stokes}, control).evaluate(directions);
    };
    // Spheres of x = 45 whose polarisation hardly shows: light is solved as if it had none.
    const Scene base = scene_of("index:1.5,0.01,radius=4");
    const Directions directions = {{0.3, 0.8}, {0.2, 0.9}, {0, 90, 180}};
    const BrdfValues left_out = values(base, directions, 0);
    CHECK(averages == 2);  // of few sizes, and those that the values are made of
    CHECK(left_out.wavelengths[0].stokes == 1);
    CHECK(left_out.slices[0].total == values(base, directions, 1).slices[0].total);
    const BrdfValues with = values(base, directions, 3);
    const std::vector<double>&all = left_out.slices[0].total, &truth = with.slices[0].total;
    const double brightest = *std::max_element(truth.begin(), truth.end());
    // Both are within the tolerance of the brightest, by averages of their own.
    for (std::size_t i = 0; i < all.size(); ++i)
        CHECK(std::abs(all[i] - truth[i]) <=
              kPromisedWithoutPolarisation * truth[i] + 2e-3 * brightest);
    // In a film below a boundary what one polarises shows at the other.
    Scene film = scene_of("isotropic:0.5", {"index:1.65,0,radius=1,variance=0.02 in "
                                            "index:1.5@0.01"});
    film.substrate = substrate("black");
    film.boundary = rte::Boundary{};
    const Directions grazing = {{0.05}, {0.4}, {0}};
    const BrdfValues chosen = values(film, grazing, 0);
    CHECK(averages == 2);
    CHECK(chosen.wavelengths[0].stokes == 3);
    CHECK(chosen.at(0, 0, 0, 0) == Approx(values(film, grazing, 3).at(0, 0, 0, 0)).epsilon(1e-3));
    CHECK(values(film, grazing, 1).at(0, 0, 0, 0) > 1.3 * chosen.at(0, 0, 0, 0));
}

TEST_CASE("auto says what the bottom of a film changes below a rough boundary",
          "[pipeline][polarisation][rules]") {
    Scene film = scene_of("isotropic:0.5", {"isotropic:0.5 in index:1.5@1e-4"});
    film.substrate = substrate("none");
    film.boundary = rte::Boundary{.roughness = 0.15};
    const Directions mirror_direction = {{0.7}, {0.7}, {0}};
    const auto report = [&](int stokes) {
        return solve(film, {550}, {.tolerance = 1e-2, .stokes = stokes})
            .evaluate(mirror_direction)
            .wavelengths[0];
    };
    // A random walk of fields over such facets: numbers are .036 too high, where both surfaces
    // reflect best what the other lets through worst.
    CHECK(report(0).polarisation_left_out >= 0.036);
    CHECK_FALSE(report(0).converged);
    CHECK(report(1).converged);
}

TEST_CASE("plan says what is done about polarisation and why", "[pipeline][polarisation][plan]") {
    const Directions directions = {{0.5}, {0.5}, {0}};
    const auto plan = [&](const std::string& words, int stokes) {
        return plan_evaluate(solve(scene_of(words), {550}, {.stokes = stokes}), directions);
    };
    CHECK(plan("hg:0.9,0.5", 0).leaves_out("polarisation"));
    CHECK(plan("index:1.5,0,radius=50", 0).leaves_out("polarisation"));
    CHECK(plan("rayleigh:0.9", 1).leaves_out("polarisation"));
    CHECK_FALSE(plan("rayleigh:0.9", 3).leaves_out("polarisation"));
    const Plan vector = plan("rayleigh:0.9", 3);
    CHECK(std::any_of(vector.steps.begin(), vector.steps.end(),
                      [](const PlannedStep& step) { return step.stage == "polarisation"; }));
}

TEST_CASE("polarisation is refused where it cannot be computed, with the reason",
          "[pipeline][polarisation][errors]") {
    const Directions directions = {{0.5}, {0.5}, {0}};
    Scene boundary = scene_of("index:1.5,0,radius=0.1 in index:1.3");
    boundary.boundary = rte::Boundary{.roughness = 0.2};
    const Scene rough = support::under_surface(scene_of("rayleigh:0.9"), 0.3, 1.5);
    for (const Scene& scene : {boundary, rough}) {
        CHECK_THROWS_WITH(solve(scene, {550}, {.stokes = 3}).mueller(directions),
                          Catch::Contains("stokes") && Catch::Contains("unpolarised"));
        CHECK(solve(scene, {550}, {.stokes = 0}).evaluate(directions).wavelengths.front().stokes ==
              1);
    }
    CHECK_THROWS_WITH(solve(scene_of("rayleigh:0.9"), {550}, {.stokes = 2}),
                      Catch::Contains("2") && Catch::Contains("3 or 4"));
}

TEST_CASE("albedos with polarisation are those of unpolarised and polarised light",
          "[pipeline][polarisation]") {
    const AlbedoValues values =
        solve(scene_of("rayleigh:0.9"), {550}, {.tolerance = 1e-6, .stokes = 3}).albedo({0.2, 1.0});
    // Spherical albedo of a Rayleigh half-space by another solver.
    CHECK(std::abs(values.spherical_albedo[0] - 0.4793955) <= 2e-6);
    REQUIRE(values.polarised_plane_albedo.size() == 1);
    REQUIRE(values.polarised_plane_albedo[0].size() == 2);
    // From the zenith no plane of polarisation is any better than another.
    CHECK(std::abs(values.polarised_plane_albedo[0][1]) <= 1e-6);
    CHECK(std::abs(values.polarised_plane_albedo[0][0]) > 1e-3);
}

TEST_CASE("large metal spheres polarise as their surface does", "[pipeline][polarisation]") {
    // Light that leaves at Theta was reflected at the incidence (180 - Theta) / 2: the signs and
    // the time factor of Fresnel's phases are those of Mie's amplitudes.
    const rte::Optics gold = optics_of_words("index:0.35,2.45,radius=20");
    const double degree = std::numbers::pi / 180.0;
    for (const double theta : {60.0, 90.0, 120.0, 150.0}) {
        const rte::ScatteringMatrix F = rte::exact_matrix(gold, std::cos(theta * degree));
        const rte::FresnelMatrix r =
            rte::fresnel_reflection(1.0, {0.35, 2.45}, std::sin(0.5 * theta * degree));
        CAPTURE(theta);
        // Interference with diffracted light and the curvature: some per cent at x = 230.
        CHECK(std::abs(F.b1 / F.a1 - (r.parallel - r.across) / (r.parallel + r.across)) <= 0.05);
        CHECK(std::abs(F.a3 / F.a1 - r.cross.real() / r.unpolarised()) <= 0.05);
        CHECK(std::abs(F.b2 / F.a1 - r.cross.imag() / r.unpolarised()) <= 0.05);
        CHECK(std::abs(r.cross.imag()) >= 0.05 * r.unpolarised());
    }
}

TEST_CASE("a smooth boundary and a mirror have Mueller matrices", "[pipeline][polarisation]") {
    Scene paint = scene_of("rayleigh:0.9 in index:1.5");
    paint.boundary = rte::Boundary{};
    const Brdf brdf = solve(paint, {550}, {.tolerance = 1e-5, .stokes = 4});
    const MuellerValues values = brdf.mueller({{0.5, 0.5}, {0.4}, {60}});
    CHECK(values.converged());
    REQUIRE(values.mirror_mueller.size() == 1);
    REQUIRE(values.mirror_mueller[0].size() == 32);
    const rte::FresnelMatrix r = rte::fresnel_reflection(1.0, 1.5, 0.5);
    CHECK(std::abs(values.mirror_mueller[0][16] - r.unpolarised()) <= 1e-14);
    CHECK(std::abs(values.mirror_mueller[0][26] - r.cross.real()) <= 1e-14);
    const AlbedoValues albedo = brdf.albedo({0.5});
    REQUIRE(albedo.mirror_reflectance.size() == 1);
    CHECK(std::abs(albedo.mirror_reflectance[0][0] - r.unpolarised()) <= 1e-14);
    CHECK(std::abs(albedo.plane_albedo[0][0] - values.plane_albedo[0][0]) <= 1e-5);
    // The polarisation by one boundary does not show in the intensity that layers scatter which do
    // not polarise; two surfaces do.
    const auto report = [](const Scene& scene) {
        return solve(scene, {550}, {.stokes = 0})
            .evaluate({{0.5}, {0.4}, {60}})
            .wavelengths.front();
    };
    Scene cloudy = scene_of("hg:0.9,0.5 in index:1.5");
    cloudy.boundary = rte::Boundary{};
    CHECK(report(cloudy).stokes == 1);
    CHECK(report(cloudy).polarisation_left_out == 0.0);
    CHECK(report(paint).stokes == 3);
}

TEST_CASE("element 11 alone is that of the whole Mueller matrices", "[pipeline][polarisation]") {
    const rte::Stack stack{.base = optics_of_words("rayleigh:0.9")};
    const rte::Directions directions{{0.1, 0.4, 0.9}, {0.05, 0.3, 0.6, 1.0}, {0, 40, 180}};
    const rte::SolverOptions options{.tolerance = 1e-5, .streams = 24};
    const int components = GENERATE(3, 4);
    const auto whole = rte::reflect_polarised(stack, directions, components, options);
    const auto intensity = rte::reflect_polarised(stack, directions, {components, true}, options);
    REQUIRE(intensity.reflection.size() == 36);
    REQUIRE(intensity.errors.size() == 36);
    const auto elements = std::size_t(components * components);
    REQUIRE(whole.reflection.size() == 36 * elements);
    for (std::size_t v = 0; v < 36; ++v) {
        CAPTURE(components, v);
        // The sums may end at different orders: a quarter of the tolerance each.
        CHECK(std::abs(intensity.reflection[v] - whole.reflection[v * elements]) <= 1e-5);
    }
    CHECK(intensity.plane_albedo == whole.plane_albedo);
    CHECK(intensity.polarised_plane_albedo == whole.polarised_plane_albedo);
}

TEST_CASE("auto tells what it leaves out below a rough boundary as below a smooth one",
          "[pipeline][polarisation][rules]") {
    Scene scene = scene_of("isotropic:1", {"index:1.8,0,radius=0.3,variance=0.05 in index:1.5@1"});
    scene.substrate = substrate("black");
    scene.boundary = rte::Boundary{.roughness = 0.2};
    const Directions directions{{0.3}, {0.2, 0.6}, {0, 90, 180}};
    const BrdfValues found = solve(scene, {550}, {.stokes = 0}).evaluate(directions);
    const WavelengthReport& rough = found.wavelengths[0];
    scene.boundary = rte::Boundary{};
    const auto light = [&](int stokes) {
        return solve(scene, {550}, {.stokes = stokes}).evaluate(directions).slices[0].total;
    };
    const auto numbers = light(1), vectors = light(3);
    const double brightest = *std::max_element(vectors.begin(), vectors.end());
    double change = 0.0;
    for (std::size_t k = 0; k < vectors.size(); ++k)
        change = std::max(change, std::abs(numbers[k] - vectors[k]) / brightest);
    CHECK(rough.stokes == 1);
    CHECK_FALSE(rough.converged);
    CHECK_THAT(found.shortfall(),
               Catch::Contains("polarisation was left out") && Catch::Contains("stokes 1"));
    CHECK(change >= 6e-3);
    // With its margin of 2, and what few nodes miss.
    CHECK(rough.polarisation_left_out >= change);
    CHECK(rough.polarisation_left_out <= 2.5 * change);
}

TEST_CASE("auto leaves out no more than it says below boundaries", "[pipeline][polarisation]") {
    std::mt19937 random(7);
    const auto uniform = [&random] { return double(random()) / 4294967296.0; };
    int computed = 0;
    for (int k = 0; k < 12; ++k) {
        const double radius = 0.55 * (2.5 + 9.5 * uniform()) / (2 * std::numbers::pi * 1.5);
        const double albedo_k = uniform() < 0.5 ? 0.0 : 0.01 * uniform();
        Scene scene = scene_of("isotropic:1",
                               {fmt::format("index:{},{},radius={},variance=0.05 in index:1.5@{}",
                                            1.2 + 1.2 * uniform() * 1.5, albedo_k, radius,
                                            std::pow(10.0, -2 + 3 * uniform()))});
        scene.substrate = substrate(uniform() < 0.5 ? "black" : "lambert:0.5");
        scene.boundary = rte::Boundary{};
        const Directions directions{
            {0.05 + 0.9 * uniform()}, {0.1 + 0.8 * uniform()}, {0, 90, 180}};
        const auto chosen = solve(scene, {550}, {.stokes = 0}).evaluate(directions);
        const auto truth = solve(scene, {550}, {.stokes = 3}).evaluate(directions);
        computed += chosen.wavelengths[0].stokes > 1 ? 1 : 0;
        for (std::size_t a = 0; a < 3; ++a) {
            CAPTURE(k, a, scene.layers[0].medium.species[0].parameters, chosen.at(0, 0, 0, a),
                    truth.at(0, 0, 0, a));
            // The promise, and the tolerances of both, which are relative to the largest.
            CHECK(std::abs(chosen.at(0, 0, 0, a) / truth.at(0, 0, 0, a) - 1) <= 6e-3 + 4e-3);
        }
    }
    CHECK(computed > 0);
}
