// Media and layers: from words, from a file of moments, and made by hand.
#include <miebrdf/error.h>
#include <miebrdf/scene.h>

#include <cmath>
#include <complex>
#include <limits>

#include "pipeline/scene/medium_kinds.h"
#include "pipeline/scene/moments_file.h"
#include "pipeline/solve/named_index.h"
#include "pipeline/solve/resolved_scene.h"
#include "tests/support/catch.h"
#include "tests/support/scenes.h"
#include "tests/support/temporary_folder.h"

using namespace miebrdf;
using Kind = mie::SizeDistributionKind;

namespace {

double relative_error(double value, double truth) { return std::abs(value / truth - 1.0); }

}  // namespace

TEST_CASE("every notation of a medium is read and written back", "[pipeline][medium]") {
    const std::string text =
        GENERATE("TiO2", "titanium dioxide", "sopra:TIO2", "index:1.5,0.01", "isotropic:0.9",
                 "rayleigh:1", "hg:0.9,-0.5", "TiO2,radius=0.25", "sopra:TIO2,variance=0.1",
                 "index:1.5,0.01,radius=2", "titanium dioxide,distribution=log-normal",
                 "index:1.5,0,radius=1e-05,variance=0.3,distribution=gamma");
    CHECK(describe(medium(text)) == text);
}

TEST_CASE("every kind of medium that is listed is read as its example says", "[pipeline][medium]") {
    for (const MediumForm& form : medium_forms()) {
        CAPTURE(form.form, form.example);
        CHECK_FALSE(form.help.empty());
        if (form.example.starts_with("moments:") || form.example.starts_with("matrix:") ||
            form.example.starts_with("scattering:"))
            continue;  // files
        CHECK(describe(medium(form.example)) == form.example);
    }
}

TEST_CASE("a medium made by hand is the one made from words", "[pipeline][medium]") {
    const support::TemporaryFolder folder;
    const std::string file = folder.write("m.csv",
                                          "# single_scattering_albedo: 0.9\n"
                                          "l,chi\n0,1\n1,0.5\n2,0.25\n");
    struct Case {
        Species by_hand;
        std::string words;
    };
    const std::vector<Case> cases = {
        {{.kind = Species::Kind::material, .name = "TiO2"}, "TiO2"},
        {{.kind = Species::Kind::material,
          .name = "sopra:TIO2",
          .sizes = {.effective_radius_um = 0.25, .distribution = Kind::gamma}},
         "sopra:TIO2,radius=0.25,distribution=gamma"},
        {{.kind = Species::Kind::index,
          .parameters = {1.5, 0.01},
          .sizes = {.effective_variance = 0.1}},
         "index:1.5,0.01,variance=0.1"},
        {{.kind = Species::Kind::isotropic, .parameters = {0.9}}, "isotropic:0.9"},
        {{.kind = Species::Kind::rayleigh, .parameters = {1}}, "rayleigh:1"},
        {{.kind = Species::Kind::henyey_greenstein, .parameters = {0.9, -0.5}}, "hg:0.9,-0.5"},
        {{.kind = Species::Kind::moments, .name = file, .parameters = {0.9}, .chi = {1, 0.5, 0.25}},
         "moments:" + file},
        {{.kind = Species::Kind::double_henyey_greenstein, .parameters = {0.9, 0.8, -0.3, 0.75}},
         "dhg:0.9,0.8,-0.3,0.75"},
    };
    for (const Case& c : cases) {
        CAPTURE(c.words);
        CHECK(c.by_hand == species(c.words));
        CHECK(Medium(c.by_hand) == medium(c.words));
        CHECK(describe(c.by_hand) == c.words);
    }
    // Also to the solver: the same bits.
    for (const std::size_t i : {2, 5, 6}) {
        Scene by_hand;
        by_hand.base = cases[i].by_hand;
        by_hand.layers = {
            {Species{.kind = Species::Kind::henyey_greenstein, .parameters = {0.5, 0.2}}, 0.3}};
        const Scene from_words = support::scene_of(cases[i].words, {"hg:0.5,0.2@0.3"});
        by_hand.particles.sizes.effective_radius_um = 1;
        Scene other = from_words;
        other.particles = by_hand.particles;
        const auto total = [](const Scene& scene) {
            return solve(scene, {550}).evaluate(support::few_directions()).slices[0].total;
        };
        CHECK(total(by_hand) == total(other));
    }
}

TEST_CASE("two Henyey-Greenstein lobes have the moments and the phase function of their sum",
          "[pipeline][medium]") {
    const Species lobes = species("dhg:0.9,0.8,-0.3,0.75");
    const rte::Optics optics = kind_of(lobes).given(lobes)->optics(550);
    CHECK(std::abs(optics.single_scattering_albedo - 0.9) <= 1e-15);
    for (int l = 0; l < 20; ++l) {
        const double exact = 0.75 * std::pow(0.8, l) + 0.25 * std::pow(-0.3, l);
        CHECK(std::abs(optics.chi[std::size_t(l)] - exact) <= 1e-15);
    }
    const auto lobe = [](double g, double x) {
        return (1 - g * g) / std::pow(1 + g * g - 2 * g * x, 1.5);
    };
    for (const double x : {-1.0, -0.2, 0.5, 1.0})
        CHECK(std::abs(optics.phase(x) / (0.75 * lobe(0.8, x) + 0.25 * lobe(-0.3, x)) - 1) <=
              1e-13);
    // One lobe alone is that of hg.
    const auto albedo = [](const std::string& base) {
        return solve(support::scene_of(base), {550}).albedo({0.5}).plane_albedo[0][0];
    };
    CHECK(std::abs(albedo("dhg:0.9,0.6,0.1,1") - albedo("hg:0.9,0.6")) <= 1e-12);
    CHECK_THROWS_WITH(species("dhg:0.9,0.8,-0.3,1.5"), Catch::Contains("[0, 1]"));
}

TEST_CASE("a table of n + ik of one's own is followed between its wavelengths",
          "[pipeline][medium]") {
    Species glass{.kind = Species::Kind::table,
                  .name = "glass of mine",
                  .wavelength_nm = {500, 600},
                  .index = {{1.6, 0.01}, {1.5, 0.02}},
                  .sizes = {.effective_radius_um = 1}};
    CHECK(needs_mie(glass));
    CHECK(describe(glass) == "table:glass of mine,radius=1");
    const ResolvedIndex index = resolve_index(glass, {500, 550, 600}, {}, 0.015);
    CHECK(index.index[0] == std::complex(1.6, 0.015));  // raised to k_floor
    CHECK(index.index[2] == std::complex(1.5, 0.02));
    // Two rows: linear in photon energy, 1 / wavelength.
    const double share = (1 / 500.0 - 1 / 550.0) / (1 / 500.0 - 1 / 600.0);
    CHECK(index.index[1].real() == Approx(1.6 - 0.1 * share));
    CHECK_THAT(index.source, Catch::Contains("glass of mine"));

    // Where the table has a row, it is the same as that constant index.
    Scene scene;
    scene.base = glass;
    const auto total = [](const Scene& asked, double nm) {
        return solve(asked, {nm}).evaluate(support::few_directions()).slices[0].total;
    };
    CHECK(total(scene, 600) == total(support::scene_of("index:1.5,0.02,radius=1"), 600));
    CHECK_THROWS_AS(solve(scene, {700}), InputError);
    CHECK_THROWS_WITH(solve(scene, {700}),
                      Catch::Contains("glass of mine") && Catch::Contains("700"));
    // Words cannot say it.
    CHECK(species("table:glass").kind == Species::Kind::material);
    for (const MediumForm& form : medium_forms()) CHECK_FALSE(form.form.empty());
}

TEST_CASE("a medium made by hand is held to what its kind allows", "[pipeline][medium][errors]") {
    struct Case {
        Species medium;
        const char* complaint;
    };
    const std::vector<Case> wrong = {
        {{}, "needs a name"},
        {{.kind = Species::Kind::henyey_greenstein, .parameters = {0.9}},
         "1 given; allowed: 2 (single-scattering albedo, asymmetry)"},
        {{.kind = Species::Kind::henyey_greenstein, .parameters = {0.9, 0.1, 0.2}}, "3 given"},
        {{.kind = Species::Kind::henyey_greenstein, .parameters = {1.9, 0.1}},
         "1.9 is out of range; allowed: [0, 1]"},
        {{.kind = Species::Kind::henyey_greenstein, .parameters = {0.9, 1}}, "(-1, 1)"},
        {{.kind = Species::Kind::index, .parameters = {1.5}}, "(n, k)"},
        {{.kind = Species::Kind::index, .parameters = {1.5, -1}}, ">= 0"},
        {{.kind = Species::Kind::material}, "material"},
        {{.kind = Species::Kind::moments, .parameters = {0.9}}, "chi"},
        {{.kind = Species::Kind::moments, .chi = {1, 0.5}}, "albedo"},
        {{.kind = Species::Kind::moments, .parameters = {0.9}, .chi = {1, 1.5}}, "1.5"},
        {{.kind = Species::Kind::moments, .parameters = {0.9}, .chi = {0.5}}, "0.5"},
        {{.kind = Species::Kind::table, .name = "mine"}, "0 wavelengths"},
        {{.kind = Species::Kind::table,
          .name = "mine",
          .wavelength_nm = {500, 600},
          .index = {1.5}},
         "2 wavelengths and 1 refractive"},
        {{.kind = Species::Kind::table,
          .name = "mine",
          .wavelength_nm = {600, 500},
          .index = {1.5, 1.5}},
         "mine"},
        {{.kind = Species::Kind::table,
          .name = "mine",
          .wavelength_nm = {500, 600},
          .index = {1.5, -1.5}},
         "mine"},
        {{.kind = Species::Kind::henyey_greenstein,
          .parameters = {0.9, 0.1},
          .sizes = {.effective_radius_um = 1}},
         "sizes"},
    };
    for (const Case& c : wrong) {
        CAPTURE(c.medium.kind, c.complaint);
        Scene scene = support::scene_of("hg:0.9,0.5");
        scene.layers = {{c.medium, 0.1}};
        CHECK_THROWS_AS(solve(scene, {550}), UsageError);
        CHECK_THROWS_WITH(solve(scene, {550}), Catch::Contains(c.complaint));
        scene.layers.clear();
        scene.base = c.medium;
        CHECK_THROWS_AS(solve(scene, {550}), UsageError);
    }
}

TEST_CASE("only materials and indices go through Mie theory", "[pipeline][medium]") {
    CHECK(needs_mie(medium("TiO2")));
    CHECK(needs_mie(medium("index:1.5,0")));
    CHECK_FALSE(needs_mie(medium("hg:0.9,0.1")));
    CHECK_FALSE(needs_mie(medium("isotropic:0.9")));
}

TEST_CASE("a layer's optical depth is what follows the last @", "[pipeline][medium]") {
    const Layer coat = layer("hg:0.9,0.5@0.1");
    CHECK(coat.depth == Depth(0.1));
    CHECK(describe(coat.medium) == "hg:0.9,0.5");
    CHECK(layer("hg:0.9,0.5@inf").depth.value == std::numeric_limits<double>::infinity());
    const Layer sized = layer("TiO2,radius=0.1,variance=0.3@1");
    CHECK(sized.depth.value == 1);
    CHECK(describe(sized.medium) == "TiO2,radius=0.1,variance=0.3");
}

TEST_CASE("media out of range are refused with the value and the range",
          "[pipeline][medium][errors]") {
    struct Case {
        const char* text;
        const char* value;
        const char* allowed;
    };
    const Case wrong =
        GENERATE(Case{"isotropic:1.2", "1.2", "[0, 1]"}, Case{"hg:0.9,1", "1", "(-1, 1)"},
                 Case{"hg:-0.1,0", "-0.1", "[0, 1]"}, Case{"hg:0.9", "hg:0.9", "hg:ALBEDO,G"},
                 Case{"index:0,1", "n 0", "> 0"}, Case{"index:1.5,-1", "k -1", ">= 0"},
                 Case{"index:1,2,3", "index:1,2,3", "index:N,K"},
                 Case{"rayleigh:nan", "nan", "finite"}, Case{"isotropic:x", "x", "not a number"});
    CAPTURE(wrong.text);
    CHECK_THROWS_AS(medium(wrong.text), UsageError);
    CHECK_THROWS_WITH(medium(wrong.text),
                      Catch::Contains(wrong.value) && Catch::Contains(wrong.allowed));
}

TEST_CASE("an index without k absorbs nothing", "[pipeline][medium]") {
    CHECK(describe(medium("index:1.5")) == describe(medium("index:1.5,0")));
    CHECK(describe(medium("index:1.5,radius=1")) == describe(medium("index:1.5,0,radius=1")));
    CHECK_THROWS_AS(medium("index:"), UsageError);
}

TEST_CASE("layers without, with negative or with senseless optical depth are refused",
          "[pipeline][medium][errors]") {
    CHECK_THROWS_WITH(layer("TiO2"), Catch::Contains("MEDIUM@DEPTH"));
    CHECK_THROWS_WITH(layer("TiO2@-1"), Catch::Contains("-1") && Catch::Contains(">= 0"));
    CHECK_THROWS_AS(layer("TiO2@nan"), UsageError);
    CHECK_THROWS_AS(layer("TiO2@-inf"), UsageError);
    CHECK_THROWS_AS(layer("TiO2@1e999"), UsageError);
    CHECK_THROWS_AS(layer("TiO2@"), UsageError);
}

TEST_CASE("sizes after a layer's optical depth are put right", "[pipeline][sizes][errors]") {
    CHECK_THROWS_AS(layer("TiO2@1,radius=0.1"), UsageError);
    CHECK_THROWS_WITH(layer("TiO2@1,radius=0.1"),
                      Catch::Contains("before the depth") && Catch::Contains("TiO2,radius=0.1@1"));
}

TEST_CASE("sizes follow a medium in any order", "[pipeline][sizes]") {
    const Species sized = species("index:1.5,0.01, distribution = mono ,radius=2");
    CHECK(describe(sized) == "index:1.5,0.01,radius=2,distribution=mono");
    CHECK(sized.parameters == std::vector<double>{1.5, 0.01});
    CHECK(sized.sizes.effective_radius_um == 2.0);
    CHECK(sized.sizes.distribution == Kind::mono);
    CHECK_FALSE(sized.sizes.effective_variance);
}

TEST_CASE("sizes that are wrong are refused with medium, key, value and what is allowed",
          "[pipeline][sizes][errors]") {
    struct Case {
        const char* text;
        std::vector<std::string> words;
    };
    const std::vector<Case> cases = {
        {"TiO2,radius=0", {"'TiO2,radius=0'", "radius 0", "> 0", "um"}},
        {"TiO2,radius=-1", {"radius -1", "> 0"}},
        {"TiO2,radius=nan", {"radius", "nan"}},
        {"index:1.5,0,radius=x", {"'index:1.5,0,radius=x'", "radius", "'x'", "not a number"}},
        {"TiO2,radius=", {"radius", "not a number"}},
        {"TiO2,variance=0", {"variance 0", "up to 10"}},
        {"TiO2,variance=10.5", {"variance 10.5", "up to 10"}},
        {"TiO2,distribution=gama", {"TiO2", "distribution 'gama'", "gamma", "log-normal"}},
        {"TiO2,radius=1,radius=2", {"radius", "twice"}},
        {"TiO2,raduis=1", {"'raduis'", "radius, variance, distribution", "did you mean radius?"}},
        {"TiO2,effective-variance=1", {"'effective-variance'", "did you mean variance?"}},
        {"TiO2,host=1.3", {"'host'", "radius, variance, distribution"}},
        {"index:1,2,3,radius=1", {"index:N,K"}},
        {",radius=1", {"empty medium"}},
        {"hg:0.9,0.5,radius=1", {"hg:", "',radius=1'", "Mie theory"}},
        {"isotropic:0.9,variance=1", {"isotropic:", "Mie theory"}},
        {"rayleigh:0.9,distribution=mono", {"rayleigh:", "Mie theory"}},
        {"moments:no such file,radius=1", {"moments:", "Mie theory"}},
    };
    for (const Case& c : cases) {
        CAPTURE(c.text);
        CHECK_THROWS_AS(medium(c.text), UsageError);
        for (const std::string& word : c.words)
            CHECK_THROWS_WITH(medium(c.text), Catch::Contains(word));
    }
}

TEST_CASE("a moments file may have commas and equals signs in its name", "[pipeline][sizes]") {
    const support::TemporaryFolder folder;
    const std::string file =
        folder.write("g=0,albedo=0.9.csv", "# single_scattering_albedo: 0.9\nl,chi\n0,1\n1,0.1\n");
    CHECK(describe(medium("moments:" + file)) == "moments:" + file);
}

TEST_CASE("a moments file gives albedo and moments in order", "[pipeline][moments_file]") {
    const support::TemporaryFolder folder;
    const auto path = folder.write("m.csv",
                                   "# made by hand\n# single_scattering_albedo: 0.9\n"
                                   "l,chi\n0,1\n1,0.5\n2,0.25\r\n");
    const MomentsFile file = read_moments_file(path);
    CHECK(file.single_scattering_albedo == 0.9);
    CHECK(file.chi == std::vector<double>{1, 0.5, 0.25});
}

TEST_CASE("a wrong moments file is refused with its name and line",
          "[pipeline][moments_file][errors]") {
    struct Case {
        const char* content;
        const char* complaint;
    };
    const Case wrong =
        GENERATE(Case{"# single_scattering_albedo: 0.9\nl,chi\n0,0.5\n", "chi_0 = 0.5"},
                 Case{"# single_scattering_albedo: 1.5\nl,chi\n0,1\n", "1.5 is out of range"},
                 Case{"# single_scattering_albedo: nan\nl,chi\n0,1\n", "nan"},
                 Case{"l,chi\n0,1\n", "single_scattering_albedo"},
                 Case{"# single_scattering_albedo: 0.9\n0,1\n", "first line must name"},
                 Case{"# single_scattering_albedo: 0.9\nl,chi\n0,1\n2,0.1\n", "expected 1"},
                 Case{"# single_scattering_albedo: 0.9\nl,chi\n0,1\n1,0.967\n2,0.1\n",
                      "degrees; allowed: nowhere negative"},
                 Case{"# single_scattering_albedo: 0.9\nl,chi\n0,1\n1,0.9\n2,0.81\n3,0.729\n",
                      "cut from a peaked function"},
                 Case{"# single_scattering_albedo: 0.9\nl,chi\n0,1\n1,-1.5\n", "chi_1 = -1.5"},
                 Case{"# single_scattering_albedo: 0.9\nl,chi\n0,1\n1,abc\n", "'abc'"},
                 Case{"# single_scattering_albedo: 0.9\nl,chi\n", "no rows"}, Case{"", "no rows"});
    const support::TemporaryFolder folder;
    const auto path = folder.write("wrong.csv", wrong.content);
    CAPTURE(wrong.content);
    CHECK_THROWS_AS(read_moments_file(path), InputError);
    CHECK_THROWS_WITH(read_moments_file(path),
                      Catch::Contains("wrong.csv:") && Catch::Contains(wrong.complaint));
}

TEST_CASE("a moments file that does not exist is named", "[pipeline][moments_file][errors]") {
    CHECK_THROWS_WITH(read_moments_file("/no/such/file.csv"), Catch::Contains("/no/such/file.csv"));
}

namespace {

/// Plane albedos and a reflectance of half-spaces in these words, at some wavelengths.
std::vector<double> values_of(const std::string& words, const std::vector<double>& nm) {
    const Brdf brdf = solve(support::scene_of(words), nm, {.streams = 16});
    const auto albedos = brdf.albedo({0.5});
    const auto table = brdf.evaluate({{0.3}, {0.8}, {60.0}});
    std::vector<double> values;
    for (std::size_t w = 0; w < nm.size(); ++w) {
        values.push_back(albedos.at(w, 0));
        values.push_back(table.at(w, 0, 0, 0));
    }
    return values;
}

}  // namespace

TEST_CASE("moments and asymmetries over wavelengths are those of each, linear between",
          "[pipeline][moments_file]") {
    const support::TemporaryFolder folder;
    const std::string spectral_moments =
        folder.write("m.csv",
                     "wavelength_nm,single_scattering_albedo,l,chi\n"
                     "400,0.5,0,1\n400,0.5,1,0.2\n"
                     "600,0.9,0,1\n600,0.9,1,0.4\n600,0.9,2,0.2\n");
    const std::string spectral_hg =
        folder.write("h.csv", "wavelength_nm,albedo,asymmetry\n400,0.5,0.2\n600,0.9,0.6\n");
    const auto moments = [&](const char* name, const std::string& rows) {
        return "moments:" + folder.write(name, rows);
    };
    const std::string at_400 =
        moments("400.csv", "# single_scattering_albedo: 0.5\nl,chi\n0,1\n1,0.2\n");
    const std::string at_450 =
        moments("450.csv", "# single_scattering_albedo: 0.6\nl,chi\n0,1\n1,0.25\n2,0.05\n");
    const std::string at_600 =
        moments("600.csv", "single_scattering_albedo,l,chi\n0.9,0,1\n0.9,1,0.4\n0.9,2,0.2\n");
    struct Case {
        std::string spectral;
        std::vector<std::string> alone;
    };
    for (const Case& c : {Case{"moments:" + spectral_moments, {at_400, at_450, at_600}},
                          Case{"hg:" + spectral_hg, {"hg:0.5,0.2", "hg:0.6,0.3", "hg:0.9,0.6"}}}) {
        CAPTURE(c.spectral);
        CHECK(describe(medium(c.spectral)) == c.spectral);
        const std::vector<double> nm = {400, 450, 600}, all = values_of(c.spectral, nm);
        for (std::size_t w = 0; w < nm.size(); ++w) {
            const std::vector<double> one = values_of(c.alone[w], {nm[w]});
            for (std::size_t i = 0; i < 2; ++i)
                CHECK(relative_error(all[2 * w + i], one[i]) <= 1e-12);  // rounding
        }
        for (const double outside : {399.0, 601.0}) {
            CHECK_THROWS_AS(solve(support::scene_of(c.spectral), {outside}), InputError);
            CHECK_THROWS_WITH(solve(support::scene_of(c.spectral), {outside}),
                              Catch::Contains("covers 400 to 600 nm"));
        }
    }
    // One albedo for all wavelengths; without wavelengths a single row.
    const std::string grey = folder.write(
        "g.csv", "# single_scattering_albedo: 0.8\nwavelength_nm,g\n400,0.2\n600,0.6\n");
    CHECK(relative_error(values_of("hg:" + grey, {500})[0], values_of("hg:0.8,0.4", {500})[0]) <=
          1e-12);
    const std::string single = folder.write("s.csv", "single_scattering_albedo,g\n0.8,0.7\n");
    CHECK(species("hg:" + single).parameters == std::vector<double>{0.8, 0.7});
    CHECK(values_of("hg:" + single, {500}) == values_of("hg:0.8,0.7", {500}));
}

TEST_CASE("files of moments, matrices and asymmetries take wavelengths in other units",
          "[pipeline][moments_file]") {
    const support::TemporaryFolder folder;
    struct Case {
        std::string kind, columns, at_400, at_500;
    };
    const Case c =
        GENERATE(Case{"moments:", "single_scattering_albedo,l,chi", "0.5,0,1\n", "0.9,0,1\n"},
                 Case{"hg:", "albedo,g", "0.5,0.2\n", "0.9,0.6\n"},
                 Case{"matrix:", "single_scattering_albedo,l,a1,a2,a3,a4,b1,b2",
                      "0.5,0,1,0,0,0,0,0\n", "0.9,0,1,0,0,0,0,0\n"});
    const auto nm_of = [&](const std::string& name, const std::string& x, const std::string& y) {
        return species(c.kind + folder.write("t.csv", name + "," + c.columns + "\n" + x + "," +
                                                          c.at_400 + y + "," + c.at_500))
            .wavelength_nm;
    };
    CAPTURE(c.kind);
    for (const auto& nm :
         {nm_of("wavelength_nm", "400", "500"), nm_of("wavelength_um", "0.4", "0.5"),
          nm_of("Wavelength (um)", "0.4", "0.5")}) {
        REQUIRE(nm.size() == 2);
        CHECK(relative_error(nm[0], 400.0) <= 1e-15);  // rounding
        CHECK(relative_error(nm[1], 500.0) <= 1e-15);
    }
    CHECK_THROWS_WITH(nm_of("wavelength_um,wavelength_nm", "0.4,400", "0.5,500"),
                      Catch::Contains("column 'wavelength_um' is unknown or there twice"));
}

TEST_CASE("wrong moments and asymmetries over wavelengths are refused with file and line",
          "[pipeline][moments_file][errors]") {
    struct Case {
        const char* kind;
        const char* content;
        const char* complaint;
    };
    const std::string albedo = "# single_scattering_albedo: 0.9\n";
    const Case wrong = GENERATE(
        Case{"moments:", "wavelength_nm,l,chi\n500,0,1\n400,0,1\n", "csv:4: wavelength 400"},
        Case{"moments:", "wavelength_nm,l,chi\n500,0,1\n600,1,0.2\n", "another wavelength"},
        Case{"moments:", "wavelength_nm,l,chi\n500,0,1\n600,0,1\n600,1,0.9\n", "negative"},
        Case{"moments:", "l,chi\n0,1\n0,1\n", "need a column 'wavelength_nm'"},
        Case{"moments:", "single_scattering_albedo,l,chi\n1.2,0,1\n", "1.2 is out of range"},
        Case{"moments:", "frequency,l,chi\n5,0,1\n", "column 'frequency' is unknown"},
        Case{"hg:", "wavelength_nm,g\n500,0.2\n500,0.3\n", "csv:4: wavelength 500"},
        Case{"hg:", "g\n0.2\n0.3\n", "need a column 'wavelength_nm'"},
        Case{"hg:", "wavelength_nm,g\n500,1\n", "asymmetry 1; allowed: (-1, 1)"},
        Case{"hg:", "wavelength_nm,albedo\n500,1\n", "no column 'g'"},
        Case{"hg:", "albedo,single_scattering_albedo,g\n1,1,0\n", "are the same"});
    const support::TemporaryFolder folder;
    const std::string words = wrong.kind + folder.write("wrong.csv", albedo + wrong.content);
    CAPTURE(wrong.content);
    CHECK_THROWS_AS(medium(words), InputError);
    CHECK_THROWS_WITH(medium(words),
                      Catch::Contains("wrong.csv:") && Catch::Contains(wrong.complaint));
    CHECK_THROWS_WITH(medium("hg:/no/such.csv"), Catch::Contains("/no/such.csv"));
}

TEST_CASE("moments and grounds are read as spreadsheets write them", "[pipeline][moments_file]") {
    const support::TemporaryFolder folder;
    const std::string mark = "\xef\xbb\xbf";
    for (const char* text : {"# single_scattering_albedo: 0.9\nl,chi\n0,1\n1,0.3\n",
                             "# single_scattering_albedo: 0,9\r\nl;chi\r\n0;1\r\n1;0,3\r\n",
                             "# single_scattering_albedo: 90 %\nl chi\n0 1\n1 0.3\n"}) {
        CAPTURE(text);
        const MomentsFile file = read_moments_file(folder.write("m.csv", mark + text));
        CHECK(file.single_scattering_albedo == 0.9);
        CHECK(file.chi == std::vector<double>{1, 0.3});
    }
    for (const char* text :
         {"wavelength_nm,albedo\n400,0.5\n700,0.6\n", "wavelength_nm;albedo\n400;0,5\n700;0,6\n",
          "wavelength_um,albedo\n0.7,0.6\n0.4,0.5\n",
          "Wavelength (nm),reflectance (%)\n400,50\n700,60\n",
          "wavelength_nm, albedo\r\n400, 50 %\r\n700, 60 %\r\n"}) {
        CAPTURE(text);
        const Substrate ground = substrate("lambert:" + folder.write("g.csv", mark + text));
        CHECK(ground.wavelength_nm == std::vector<double>{400, 700});
        CHECK(ground.albedo == std::vector<double>{0.5, 0.6});
    }
    CHECK_THROWS_WITH(
        substrate("lambert:" + folder.write("p.csv", "wavelength_nm,albedo\n400,50\n700,60\n")),
        Catch::Contains("p.csv:2") && Catch::Contains("50") && Catch::Contains("percent"));
}

TEST_CASE("a matrix with a negative phase function is refused", "[pipeline][errors]") {
    const support::TemporaryFolder folder;
    const std::string file = folder.write("neg.csv",
                                          "# single_scattering_albedo: 0.9\nl,a1,a2,a3,a4,b1,b2\n"
                                          "0,1,0,0,0.5,0,0\n1,2.9,0,0,1,0,0\n2,0.5,3,0,0,0.7,0\n");
    CHECK_THROWS_WITH(medium("matrix:" + file),
                      Catch::Contains("180.0 degrees") && Catch::Contains("nowhere negative"));
}

TEST_CASE("log-normal sizes by median and geometric deviation", "[pipeline][sizes]") {
    const double s2 = std::pow(std::log(1.6), 2);
    const auto sizes = species("TiO2,median=0.1,sigma_g=1.6").sizes;
    CHECK(relative_error(*sizes.effective_radius_um, 0.1 * std::exp(2.5 * s2)) <= 1e-14);
    CHECK(relative_error(*sizes.effective_variance, std::exp(s2) - 1) <= 1e-14);
    CHECK(sizes.distribution == mie::SizeDistributionKind::log_normal);
    const auto by_volume = species("TiO2,median=0.1,sigma_g=1.6,by=volume").sizes;
    CHECK(relative_error(*by_volume.effective_radius_um, 0.1 * std::exp(-0.5 * s2)) <= 1e-14);
    CHECK_THROWS_WITH(species("TiO2,median=0.1"), Catch::Contains("belong together"));
    CHECK_THROWS_WITH(species("TiO2,median=0.1,sigma_g=1.6,radius=1"), Catch::Contains("variance"));
    CHECK_THROWS_WITH(species("TiO2,median=0.1,sigma_g=0.5"), Catch::Contains("0.5"));
    CHECK_THROWS_WITH(species("TiO2,median=0.1,sigma_g=1.6,by=weight"), Catch::Contains("weight"));
}

TEST_CASE("indices and amounts as laboratories write them", "[pipeline]") {
    CHECK(species("index:1.5+0.01i,radius=1") == species("index:1.5,0.01,radius=1"));
    CHECK(species("index:1.5+1e-3i") == species("index:1.5,1e-3"));
    CHECK(host("1.5+0.01i").index == std::complex<double>(1.5, 0.01));
    CHECK_THROWS_WITH(species("index:1.5-0.01i"), Catch::Contains("n - ik"));
    CHECK(species("carbon,mass=100ng/g").amount == species("carbon,mass=100ppb").amount);
    CHECK(species("carbon,mass=3mg/kg").amount == species("carbon,mass=3ppm").amount);
    CHECK(species("carbon,mass=0").amount->value == 0.0);
    CHECK_THROWS_WITH(species("carbon,mass=-1%"), Catch::Contains("-0.01"));
}
