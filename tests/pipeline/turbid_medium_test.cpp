// Media by what laboratories measure of them: pastes and turbid media.
#include <miebrdf/brdf.h>
#include <miebrdf/error.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <fstream>
#include <limits>
#include <numbers>
#include <string>

#include "pipeline/solve/resolved_scene.h"
#include "tests/support/catch.h"
#include "tests/support/scenes.h"
#include "tests/support/temporary_folder.h"

using namespace miebrdf;

namespace {

Scene film_of(const std::string& layer) {
    Scene scene;
    scene.substrate = substrate("black");
    scene.layers = {miebrdf::layer(layer)};
    return scene;
}

auto albedos_at(const Scene& scene, const std::vector<double>& wavelength_nm, double mu_in) {
    return solve(scene, wavelength_nm, {.tolerance = 1e-6}).albedo({mu_in});
}

std::string paste_file(const support::TemporaryFolder& folder, const char* name,
                       const std::string& text) {
    const std::string path = folder / name;
    std::ofstream(path) << text;
    return path;
}

}  // namespace

TEST_CASE("a turbid film is a Henyey-Greenstein film of its optical depth", "[pipeline][turbid]") {
    // mu_s = 1.2 / (1 - 0.8) = 6 per mm and mu_a = 0.3: albedo 6 / 6.3, depth 6.3 * 0.05.
    const auto turbid = albedos_at(film_of("turbid:0.3,1.2,0.8@50um"), {550}, 0.7);
    const auto same = albedos_at(film_of("hg:0.9523809523809523,0.8@0.315"), {550}, 0.7);
    CHECK(std::abs(turbid.plane_albedo[0][0] - same.plane_albedo[0][0]) <= 1e-12);
}

TEST_CASE("pastes add what they scatter and absorb, by volume or by weight", "[pipeline][turbid]") {
    const support::TemporaryFolder folder;
    const std::string columns = "wavelength_nm,mu_s_reduced,mu_a\n";
    const auto a = paste_file(folder, "a.csv", columns + "500,10,1\n600,20,3\n");
    // The same paint measured as a film of which it is a half.
    const auto half =
        paste_file(folder, "half.csv", "# volume: 50%\n" + columns + "500,5,0.5\n600,10,1.5\n");
    const auto b = paste_file(folder, "b.csv", columns + "500,30,5\n600,40,1\n");
    const auto b_by_weight =
        paste_file(folder, "w.csv", "# weight: 1\n" + columns + "500,30,5\n600,40,1\n");
    const auto total = [&](const std::string& words) {
        return albedos_at(film_of(words + "@40um"), {550}, 0.6).plane_albedo[0][0];
    };
    // At 550 nm a has 15 and 2, b 35 and 3 per mm: linear between the rows.
    CHECK(std::abs(total("paste:" + a) - total("turbid:2,15,0")) <= 1e-12);
    CHECK(std::abs(total("paste:" + half) - total("turbid:2,15,0")) <= 1e-12);
    CHECK(std::abs(total("paste:" + a + ",volume=25%") - total("turbid:0.5,3.75,0")) <= 1e-12);
    CHECK(std::abs(total("paste:" + a + ",volume=40% + paste:" + b + ",volume=60%") -
                   total("turbid:2.6,27,0")) <= 1e-12);
    CHECK(
        std::abs(total("paste:" + b_by_weight + ",mass=50% + paste:" + a + ",density=1,mass=50%") -
                 total("turbid:2.5,25,0")) <= 1e-12);
}

TEST_CASE("a turbid medium has a share of its layer beside pastes", "[pipeline][turbid]") {
    const support::TemporaryFolder folder;
    const auto white =
        paste_file(folder, "white.csv", "# weight: 1\nwavelength_nm,mu_s_reduced,mu_a\n550,30,1\n");
    const auto albedo = [&](const std::string& words) {
        return albedos_at(film_of(words + "@40um"), {550}, 0.6).plane_albedo[0][0];
    };
    const double mixed = albedo("turbid:6,25,0");  // 0.2 (26, 5) + 0.8 (1, 30)
    CHECK(std::abs(albedo("turbid:26,5,0,volume=20% + paste:" + white + ",volume=80%") - mixed) <=
          1e-12);
    CHECK(std::abs(albedo("turbid:26,5,0,density=1 + paste:" + white + ",mass=80%") - mixed) <=
          1e-12);
}

TEST_CASE("a turbid medium alone has no share of its layer", "[pipeline][turbid]") {
    CHECK_THROWS_WITH(medium("turbid:0.01,1,0.8,volume=2%"), Catch::Contains("fills its layer"));
    CHECK_NOTHROW(medium("turbid:0.01,1,0.8"));
    CHECK_NOTHROW(medium("paste:acrylic_white,volume=2%"));
}

TEST_CASE("a half-space has no depth", "[pipeline][turbid]") {
    for (const char* text : {"turbid:0.01,1,0.9@2mm", "hg:0.9,0.5@1", "TiO2,radius=0.2@3um"})
        CHECK_THROWS_WITH(medium(text), Catch::Contains("depth of a layer"));
    CHECK_NOTHROW(medium("TiO2,radius=0.2,coating=SiO2@5nm"));
    CHECK_THROWS_WITH(medium("hg:no@file.csv"), !Catch::Contains("depth of a layer"));
}

TEST_CASE("a paste mixes with spheres", "[pipeline][turbid]") {
    const support::TemporaryFolder folder;
    const auto black =
        paste_file(folder, "black.csv", "wavelength_nm,mu_s_reduced,mu_a\n550,0,50\n");
    const std::string white = "TiO2,radius=0.13,volume=10%", host = " in index:1.5@40um";
    const auto alone = solve(film_of(white + host), {550}).layers();
    const auto mixed =
        solve(film_of(white + " + paste:" + black + ",volume=20%" + host), {550}).layers();
    CHECK(std::abs(*mixed[0].scattering_per_um / *alone[0].scattering_per_um - 1) <= 1e-12);
    CHECK(std::abs(*mixed[0].absorption_per_um - *alone[0].absorption_per_um - 0.010) <= 1e-12);
}

TEST_CASE("weights of particles and a paste tell their volumes", "[pipeline][turbid]") {
    const support::TemporaryFolder folder;
    const auto paste = paste_file(folder, "w.csv",
                                  "# density: 1.25\nwavelength_nm,mu_s_reduced,mu_a\n"
                                  "500,30,5\n600,40,1\n");
    const std::string spheres = " + index:2.6,radius=0.13,density=4,";
    // .2 g of 4 g/cm3 in .8 g of 1.25 g/cm3: .05 of .69 cm3.
    const auto by_mass = film_of("paste:" + paste + spheres + "mass=20%@40um");
    const auto by_volume = film_of(fmt::format("paste:{},volume={}{}volume={}@40um", paste,
                                               0.64 / 0.69, spheres, 0.05 / 0.69));
    CHECK(std::abs(albedos_at(by_mass, {550}, 0.6).plane_albedo[0][0] -
                   albedos_at(by_volume, {550}, 0.6).plane_albedo[0][0]) <= 1e-12);
}

TEST_CASE("acrylic pastes say where their unit of length is missed", "[pipeline][turbid]") {
    const auto notes = [](const Scene& scene) {
        return fmt::format("{}", fmt::join(solve(scene, {550}).albedo({1}).notes, "; "));
    };
    const auto said = Catch::Contains("no absolute meaning");
    const std::string red = "paste:acrylic_red,volume=50% + ", white = "paste:acrylic_white";
    CHECK_THAT(notes(film_of(white + "@20um")), said);
    CHECK_THAT(notes(support::scene_of(red + "paste:oil_zinc_white,volume=50%")), said);
    CHECK_THAT(notes(support::scene_of(red + white + ",volume=50%")), !said);
    CHECK_THAT(notes(film_of(white + "@inf")), !said);
    CHECK_THAT(notes(film_of("paste:oil_zinc_white@1mm")), !said);
}

TEST_CASE("embedded acrylics have the colours of their patches, alone and with white",
          "[pipeline][turbid]") {
    // Reflectances in percent of opaque patches at 450, 550, 650 nm: repository
    // miciwan/PaintMixing (MIT licence), data/masstone.json and data/mix1.json. Three readings of
    // a patch differ by .3 in the median (standard deviation); the pastes are made of them.
    struct Patch {
        const char* words;
        double percent[3];
    };
    const Patch patches[] = {
        {"paste:acrylic_white", {91.09, 92.49, 91.50}},
        {"paste:acrylic_yellow_oxide", {6.06, 27.62, 36.51}},
        {"paste:acrylic_red_oxide", {3.89, 4.78, 22.06}},
        {"paste:acrylic_yellow_oxide,mass=32.9545% + paste:acrylic_white", {27.57, 57.79, 65.28}},
        {"paste:acrylic_red_oxide,mass=36.3636% + paste:acrylic_white", {14.54, 14.19, 38.64}},
    };
    for (const Patch& patch : patches) {
        Scene scene;
        scene.base = medium(std::string(patch.words) + " in index:1.5");
        scene.boundary = boundary("smooth");
        const auto found = albedos_at(scene, {450, 550, 650}, std::cos(8 * M_PI / 180));
        for (std::size_t w = 0; w < 3; ++w) {
            const double seen = found.plane_albedo[w][0] - found.mirror_reflectance[w][0];
            CAPTURE(patch.words, w);
            CHECK(std::abs(100 * seen - patch.percent[w]) <= 0.3);
        }
    }
}

TEST_CASE("embedded oil paints have the reflectances of their drawdowns, alone and with white",
          "[pipeline][turbid]") {
    // Percent at 450, 550, 650 nm: of the white card (paint 07A), and of films over it. Geldof et
    // al., Heritage Science 6:17 (2018), data of the repository fligt/revigo-spectra (CC0).
    const double card[3] = {81.71, 85.33, 87.51};
    struct Film {
        const char* paint;
        double percent[3];
    };
    const Film films[] = {
        {"paste:oil_zinc_white", {84.90, 86.98, 87.73}},  // 07A
        {"paste:oil_vermilion", {6.59, 7.49, 54.83}},     // 06A
        {"paste:oil_vermilion,mass=10% + paste:oil_zinc_white,mass=90%", {32.89, 30.40, 81.86}},
        {"paste:oil_viridian", {5.74, 5.30, 4.17}},                                      // 09A
        {"paste:oil_viridian,mass=49.7% + paste:oil_zinc_white", {15.60, 15.36, 8.14}},  // 09C
    };
    // The card's albedo below the binder: at 8 degrees .0400 is reflected by it, of diffuse light
    // .5964 from inside (Fresnel, index 1.5; Duntley 1942).
    const double first = 0.0400, inside = 0.5964;
    for (const Film& film : films) {
        for (std::size_t w = 0; w < 3; ++w) {
            const double out = (card[w] / 100 - first) / (1 - first);
            Scene scene = film_of(std::string(film.paint) + " in index:1.5@1mm");
            scene.substrate =
                substrate(fmt::format("lambert:{}", out / (1 - inside + inside * out)));
            scene.boundary = boundary("smooth");
            const double nm = 450 + 100.0 * double(w);
            const auto found = albedos_at(scene, {nm}, std::cos(8 * M_PI / 180));
            CAPTURE(film.paint, nm);
            // Films of one paint are nominally equal: one set of coefficients misses them
            // by .005 (viridian) to .008 (vermilion).
            CHECK(std::abs(found.plane_albedo[0][0] - film.percent[w] / 100) <= 0.02);
        }
    }
}

TEST_CASE("titanium white is as white and as violet as measured paint", "[pipeline][turbid]") {
    // Percent, mirror part excluded, of an opaque patch: repository miciwan/PaintMixing, masstone
    // of the white. Spheres of radius 0.125 um, for which k was found: 0.3 is the rounding of k.
    Scene scene;
    scene.base = medium("TiO2_pigment,radius=0.125,volume=15% in index:1.5");
    scene.boundary = boundary("smooth");
    const auto seen = albedos_at(scene, {390, 450, 550, 650}, std::cos(8 * M_PI / 180));
    const double percent[3] = {91.09, 92.48, 91.50};
    for (std::size_t w = 1; w < 4; ++w) {
        const double found = seen.plane_albedo[w][0] - seen.mirror_reflectance[w][0];
        CHECK(std::abs(100 * found - percent[w - 1]) <= 0.3);
    }
    // K / S of 0.227 (Artist Paint Spectral Database) is (1 - R)^2 / (2 R) at R = 0.516 inside,
    // which Saunderson's correction with the constants of that database (0.03, 0.65) shows as
    // 0.263.
    const double violet = seen.plane_albedo[0][0] - seen.mirror_reflectance[0][0];
    CHECK(std::abs(violet - 0.97 * 0.35 * 0.516 / (1 - 0.65 * 0.516)) <= 0.02);
}

TEST_CASE("a table that is not good for colours says so in visible light", "[pipeline][turbid]") {
    const auto notes_of = [](const char* words, double nm) {
        Scene scene;
        scene.base = medium(words);
        return fmt::format("{}", fmt::join(resolve(scene, {nm}).notes, "; "));
    };
    CHECK_THAT(notes_of("Fe3O4,radius=0.1", 550), Catch::Contains("black iron oxide is neutral"));
    CHECK_THAT(notes_of("Fe3O4,radius=0.1", 1000), !Catch::Contains("not for colours"));
    CHECK_THAT(notes_of("CdS,radius=0.1", 550), !Catch::Contains("not for colours"));
}

TEST_CASE("pastes and turbid media refuse what they cannot have", "[pipeline][turbid][errors]") {
    const support::TemporaryFolder folder;
    CHECK_THROWS_WITH(medium("turbid:0.3,1.2,0.8,number=1e6/cm3"), Catch::Contains("volume="));
    CHECK_THROWS_WITH(medium("turbid:-1,1.2,0.8"), Catch::Contains("-1"));
    CHECK_THROWS_WITH(solve(film_of("turbid:0,0,0@1mm"), {550}), Catch::Contains("neither"));
    CHECK_THROWS_WITH(medium("paste:vermilion"), Catch::Contains("acrylic_white"));
    CHECK_THROWS_WITH(medium("paste:acrylic_white,radius=1"), Catch::Contains("radius"));
    CHECK_THROWS_WITH(solve(film_of("paste:acrylic_white@40um"), {350}),
                      Catch::Contains("400 to 700"));
    CHECK_THROWS_WITH(medium("paste:" + paste_file(folder, "n.csv",
                                                   "wavelength_nm,mu_s_reduced,mu_a\n500,-1,1\n")),
                      Catch::Contains("-1"));
    CHECK_THROWS_WITH(
        medium("paste:" + paste_file(folder, "v.csv",
                                     "# volume: 0\nwavelength_nm,mu_s_reduced,mu_a\n500,1,1\n")),
        Catch::Contains("above 0"));
}

TEST_CASE("slides above and below a turbid film reflect, absorb and pass as iad has them",
          "[pipeline][turbid]") {
    // Scott Prahl's iad 4.0.0 with 32 (36) directions, to the digits that it prints: -z -a 0.9 -b 1
    // -g 0.8 -n 1.4 -N 1.5, and -A 0.1 -j 1 -g 0 -n 1.34 -N 1.45 -E 0.1 (depth of each slide) at
    // normal incidence and at 60 degrees. Its single terms of polarisation are averaged at each
    // surface, which at 60 degrees counts in the last digit.
    const double k = 0.1 * 550e-6 / (4.0 * std::numbers::pi);  // depth 0.1 in 1 mm at 550 nm
    struct Case {
        std::string slide, film;
        double mu_in, r, r_u, t, t_u;
    };
    const Case cases[] = {
        {"slide:1.5", "turbid:0.1,0.18,0.8 in index:1.4", 1.0, .1064, .0462, .7190, .3383},
        {fmt::format("slide:1.45,{}", k), "turbid:0.1,1,0 in index:1.34", 1.0, .1789, .0374, .3815,
         .2537},
        {fmt::format("slide:1.45,{}", k), "turbid:0.1,1,0 in index:1.34", 0.5, .2376, .0845, .2896,
         .1552}};
    for (const auto& [slide, film, mu_in, r, r_u, t, t_u] : cases) {
        CAPTURE(slide, mu_in);
        Scene scene;
        scene.substrate = substrate("none");
        scene.boundary = rte::Boundary{};
        scene.layers = {layer(slide + "@1mm"), layer(film + "@1mm"), layer(slide + "@1mm")};
        const auto values = solve(scene, {550}, {.tolerance = 1e-6, .stokes = 1}).albedo({mu_in});
        CHECK(std::abs(values.plane_albedo[0][0] - r) <= 0.6e-4);
        CHECK(std::abs(values.mirror_reflectance[0][0] - r_u) <= 0.6e-4);
        CHECK(std::abs(values.plane_transmittance[0][0] - t) <= 0.6e-4);
        CHECK(std::abs(values.unscattered_transmittance[0][0] - t_u) <= 0.6e-4);
    }
}

TEST_CASE("unscattered light follows Beer's law", "[pipeline][turbid]") {
    const auto values = solve(film_of("hg:0.9,0.7@2"), {550}).albedo({0.5, 0.5, 1.0});
    for (std::size_t i = 0; i < 3; ++i) {
        const double truth = std::exp(-2.0 / values.mu_in[i]);
        CHECK(std::abs(values.unscattered_transmittance[0][i] / truth - 1.0) <= 1e-12);
    }
}

TEST_CASE("slides are refused where they cannot stand, with what to write",
          "[pipeline][turbid][errors]") {
    CHECK(describe(medium("slide:1.5,1e-6")) == "slide:1.5,1e-06");
    CHECK(medium(describe(medium("slide:1.5"))) == medium("slide:1.5"));
    CHECK_THROWS_WITH(medium("slide:1.5 in PMMA"), Catch::Contains("layer of its own"));
    CHECK_THROWS_WITH(medium("slide:1.5 + TiO2,volume=1%"), Catch::Contains("layer of its own"));
    CHECK_THROWS_WITH(medium("slide:1.5,volume=10%"), Catch::Contains("index alone"));
    CHECK_THROWS_WITH(medium("slide:-1"), Catch::Contains("n > 0"));
    Scene scene = film_of("slide:1.5@1mm");
    CHECK_THROWS_WITH(solve(scene, {550}), Catch::Contains("boundary smooth"));
    scene.boundary = rte::Boundary{};
    CHECK_NOTHROW(solve(scene, {550}));
    scene.layers = {layer("slide:1.5@0.1")};
    CHECK_THROWS_WITH(solve(scene, {550}), Catch::Contains("slide:1.5,0@1mm"));
    scene = {};
    scene.base = medium("slide:1.5");
    CHECK_THROWS_WITH(solve(scene, {550}), Catch::Contains("half-space"));
}
