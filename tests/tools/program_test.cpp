// The program's contract: names, columns, formats and a few values known from outside.
#include <cmath>
#include <nlohmann/json.hpp>

#include "tests/support/catch.h"
#include "tests/support/program_csv.h"
#include "tests/support/reference_table.h"
#include "tests/support/temporary_folder.h"

using namespace miebrdf;
using support::csv_of;
using Columns = std::vector<std::string>;

TEST_CASE("columns are those that scripts depend on", "[program]") {
    CHECK(csv_of("sphere --index 1.5,0 --size-parameter 1").columns() ==
          Columns{"n", "k", "size_parameter", "q_ext", "q_sca", "q_abs", "q_back", "asymmetry"});
    CHECK(csv_of("sphere --index 1.5,0 --size-parameter 1 --angles 0,90").columns() ==
          Columns{"n", "k", "size_parameter", "angle_deg", "s1_re", "s1_im", "s2_re", "s2_im"});
    CHECK(csv_of("optics hg:0.9,0.5 --wavelengths 550 --moments 2").columns() ==
          Columns{"wavelength_nm", "n", "k", "single_scattering_albedo", "asymmetry", "q_ext",
                  "error_estimate", "chi_0", "chi_1", "chi_2"});
    CHECK(csv_of("phase hg:0.9,0.5 --wavelengths 550 --angles 0,180").columns() ==
          Columns{"wavelength_nm", "angle_deg", "phase", "error_estimate"});
    CHECK(csv_of("phase hg:0.9,0.5 --wavelengths 550 --angles 0,180 --stokes").columns() ==
          Columns{"wavelength_nm", "angle_deg", "f11", "f22", "f33", "f44", "f12", "f34",
                  "error_estimate"});
    CHECK(csv_of("brdf --base isotropic:0.9 --mu-in 1 --mu-out 1").columns() ==
          Columns{"wavelength_nm", "mu_in", "mu_out", "azimuth_deg", "brdf"});
    CHECK(csv_of("brdf --base isotropic:0.9 --mu-in 1 --mu-out 1 --quantity reflection")
              .columns()
              .back() == "reflection");
    CHECK(csv_of("albedo --base isotropic:0.9").columns() ==
          Columns{"wavelength_nm", "mu_in", "plane_albedo", "spherical_albedo"});
    CHECK(csv_of("table1 SiO2").columns() == Columns{"material", "channel", "wavelength_nm",
                                                     "diffuse_reflectance_factor", "paper",
                                                     "difference"});
}

TEST_CASE("a printed scattering matrix is that of a sphere's amplitudes", "[program]") {
    // Bohren & Huffman (1983), eq. 4.77: f12 / f11 and f34 / f11 of S1 and S2; one size.
    const std::string angles = " --angles 0,30,100,180";
    const auto matrix = csv_of(
        "phase index:1.5,0.01,radius=0.3,distribution=mono --stokes --wavelengths 600" + angles);
    const auto sphere =
        csv_of("sphere --index 1.5,0.01 --size-parameter 3.14159265358979" + angles);
    for (std::size_t row = 0; row < 4; ++row) {
        const auto f = [&](const char* name) { return matrix.number(row, name); };
        const auto s = [&](const char* name) { return sphere.number(row, name); };
        const double one = std::pow(s("s1_re"), 2) + std::pow(s("s1_im"), 2),
                     two = std::pow(s("s2_re"), 2) + std::pow(s("s2_im"), 2);
        CAPTURE(row);
        CHECK(f("f22") == Approx(f("f11")).epsilon(1e-12));
        CHECK(f("f44") == Approx(f("f33")).epsilon(1e-12).margin(1e-12));
        CHECK(std::abs(f("f12") / f("f11") - (two - one) / (two + one)) <= 1e-9);
        const double cross = s("s2_im") * s("s1_re") - s("s2_re") * s("s1_im");
        CHECK(std::abs(f("f34") / f("f11") - 2 * cross / (two + one)) <= 1e-9);
    }
}

TEST_CASE("a spheroid of equal axes is the sphere, and small ones scatter by their shape",
          "[program]") {
    const auto round = csv_of("sphere --index 1.5,0.01 --size-parameter 0.01,3 --aspect 1");
    const auto sphere = csv_of("sphere --index 1.5,0.01 --size-parameter 0.01,3");
    for (const std::string name : {"q_ext", "q_sca", "q_abs", "q_back", "asymmetry"}) {
        for (std::size_t row = 0; row < 2; ++row) {
            CAPTURE(name, row);
            CHECK(std::abs(round.number(row, name) - sphere.number(row, name)) <=
                  1e-8 * std::abs(sphere.number(row, "q_ext")));
        }
    }
    // Bohren & Huffman (1983), section 5.3: polarisabilities (m^2 - 1) / (3 + 3 L (m^2 - 1)) of an
    // oblate spheroid along its axes, L of its axis of rotation by their eq. 5.33.
    const double aspect = 2, e2 = 1 - 1 / (aspect * aspect), eps = 1.5 * 1.5 - 1;
    const double g = std::sqrt((1 - e2) / e2);
    const double equator = g / (2 * e2) * (std::acos(-1.0) / 2 - std::atan(g)) - 0.5 * g * g;
    double ratio = 0;  // of scattering to that of the sphere
    for (const double L : {equator, equator, 1 - 2 * equator})
        ratio += std::pow((1 + eps / 3) / (1 + L * eps), 2) / 3;
    const double small =
        csv_of("sphere --index 1.5 --size-parameter 0.01 --aspect 2").number(0, "q_sca");
    const double ball = csv_of("sphere --index 1.5 --size-parameter 0.01").number(0, "q_sca");
    CHECK(small / ball == Approx(ratio).epsilon(1e-4));  // terms in x^2
}

TEST_CASE("a half-space that absorbs nothing reflects 1, printed as 1", "[program]") {
    for (const char* surface :
         {"", " --roughness 0.3 --surface-index 1.5", " --roughness 0.1 --surface-index 2.6"}) {
        const auto csv =
            csv_of(std::string("albedo --base hg:1,0.5 --coat hg:1,0.8@0.7") + surface);
        CAPTURE(surface);
        for (std::size_t row = 0; row < csv.size(); ++row) {
            CHECK(csv.text(row, "plane_albedo") == "1");
            CHECK(csv.text(row, "spherical_albedo") == "1");
        }
    }
}

TEST_CASE("outputs tell the particles that Mie theory took, defaults included", "[program]") {
    const std::string wanted =
        "# particles: power-law, effective radius 1 um, effective variance 0.2, in a host of index "
        "1\n";
    for (const char* command :
         {"optics index:1.5,0.1", "phase index:1.5,0.1", "albedo --base index:1.5,0.1",
          "albedo --base isotropic:0.5 "
          "--coat index:1.5,0.1@1"}) {
        const auto run =
            support::run_program(std::string(command) + " --wavelengths 550 --effective-radius 1");
        CAPTURE(command, run.err);
        CHECK_THAT(run.out, Catch::Contains(wanted));
    }
    CHECK_THAT(support::run_program("optics hg:0.9,0.5").out, !Catch::Contains("# particles"));
}

TEST_CASE("the largest albedo of layers that absorb nothing is reported as at most 1",
          "[program]") {
    const std::string medium = GENERATE("hg:1,0.5", "hg:1,0.9", "rayleigh:1");
    const auto run = support::run_program("brdf --base " + medium +
                                          " --wavelengths 550 --mu-in 0.1:1:0.1 --mu-out 1 --json");
    const auto report = nlohmann::json::parse(run.out)["report"][0];
    CAPTURE(medium);
    CHECK(report["largest_albedo"] <= 1.0);
    // Conservation itself, to what the solution says of its error.
    CHECK(report["largest_albedo"] >= 1.0 - report["error_estimate"].get<double>());
}

TEST_CASE("albedo --colour gives the colours of its spectra", "[program][colour]") {
    const std::string scene = "albedo --base hg:0.9,0.5 --mu-in 0.5,1 --wavelengths 400:700:10";
    const auto spectra = csv_of(scene);
    const auto colours = csv_of(scene + " --colour d65");
    CHECK(colours.columns() == Columns{"quantity", "mu_in", "x", "y", "z", "lab_l", "lab_a",
                                       "lab_b", "srgb_red", "srgb_green", "srgb_blue", "lch_c",
                                       "lch_h", "colour_error"});
    REQUIRE(colours.size() == 3);
    // A grey: Y is the albedo, and neither a nor b are there; all to six decimals.
    for (std::size_t row = 0; row < 3; ++row) {
        const double albedo =
            row < 2 ? spectra.number(row, "plane_albedo") : spectra.number(0, "spherical_albedo");
        CHECK(std::abs(colours.number(row, "y") - albedo) <= 0.51e-6);
        CHECK(std::abs(colours.number(row, "lab_l") - (116 * std::cbrt(albedo) - 16)) <= 0.51e-6);
        CHECK(colours.text(row, "lab_a") == "0");
        CHECK(colours.text(row, "lab_b") == "0");
    }
    CHECK(colours.text(2, "quantity") == "spherical_albedo");
    // Wavelengths in any order.
    const auto backward = csv_of(
        "albedo --base hg:0.9,0.5 --mu-in 0.5,1 --wavelengths 700:400:-10 "
        "--colour d65");
    CHECK(backward.text(0, "lab_l") == colours.text(0, "lab_l"));
    for (const char* options :
         {" --colour d55", " --colour d65,5", " --colour d65 --wavelengths rgb",
          " --colour d65 --wavelengths 400:500:10"}) {
        CAPTURE(options);
        CHECK(support::run_program(std::string("albedo --base hg:0.9,0.5") + options).exit_code ==
              2);
    }
}

TEST_CASE("facts that are numbers are numbers in JSON", "[program]") {
    const auto run =
        support::run_program("brdf --base hg:0.9,0.5 --mu-in 1 --mu-out 1 --tolerance 1e-4 --json");
    const auto facts = nlohmann::json::parse(run.out)["facts"];
    CHECK(facts["tolerance"] == 1e-4);
    REQUIRE(facts["error_estimate"].is_number());
    CHECK(facts["error_estimate"] <= 1e-4);
}

TEST_CASE("phase_noise names the direction where it is worst", "[program]") {
    const auto run = support::run_program(
        "brdf --base index:1.5,0 --effective-radius 5 --wavelengths 500,550 --mu-in 0.5 --mu-out "
        "0.25,0.5 --azimuth 90,180");
    const std::size_t at = run.out.find("# phase_noise:");
    REQUIRE(at != std::string::npos);
    const std::string line = run.out.substr(at, run.out.find('\n', at) - at);
    CAPTURE(line);
    CHECK_THAT(line, Catch::Contains(" nm, mu_in 0.5, mu_out 0.") && Catch::Contains("azimuth "));
}

TEST_CASE("a range ends with its last step that is not beyond its end", "[program]") {
    CHECK(csv_of("optics hg:0.9,0.5 --wavelengths 400:705:100").size() == 4);
    CHECK(csv_of("optics hg:0.9,0.5 --wavelengths 400:700:100").size() == 4);
    CHECK(csv_of("optics hg:0.9,0.5 --wavelengths 700:400:-100").size() == 4);
}

TEST_CASE("an isotropic half-space agrees with Chandrasekhar's H-function", "[program]") {
    // R(1, 1) = alpha/8 H(1)^2 with the tabulated H(1) for albedo 0.5.
    const support::ReferenceTable table("rte/chandrasekhar_H_isotropic.csv");
    for (std::size_t row = 0; row < table.size(); ++row) {
        if (table.text(row, "albedo") != "0.5" || table.number(row, "mu") != 1.0) continue;
        const double h = table.number(row, "H");
        const auto csv = csv_of(
            "brdf --base isotropic:0.5 --mu-in 1 --mu-out 1 --wavelengths 550 "
            "--quantity reflection --tolerance 1e-6");
        // The tolerance that was asked for.
        CHECK(std::abs(csv.number(0, "reflection") / (0.5 / 8 * h * h) - 1) <= 1e-6);
        return;
    }
    FAIL("no row for albedo 0.5, mu 1");
}

TEST_CASE("the quantity brdf is reflection over pi, and components add up", "[program]") {
    const std::string scene =
        "brdf --base TiO2 --wavelengths 550 --mu-in 0.6 --mu-out 0.5 --azimuth 90 "
        "--roughness 0.3 --component total,subsurface,surface";
    const auto brdf = csv_of(scene);
    const auto reflection = csv_of(scene + " --quantity reflection");
    CHECK(std::abs(reflection.number(0, "reflection_total") / M_PI / brdf.number(0, "brdf_total") -
                   1) <= 1e-15);
    // Eq. 5: what is left of the subsurface part is 1 - rho, between 0 and 1.
    const double transmitted = (brdf.number(0, "brdf_total") - brdf.number(0, "brdf_surface")) /
                               brdf.number(0, "brdf_subsurface");
    CHECK(transmitted > 0.5);
    CHECK(transmitted < 1.0);
}

TEST_CASE("JSON holds the same values as CSV", "[program]") {
    const std::string arguments = "albedo --base hg:0.9,0.5 --mu-in 0.3,1 --wavelengths 550";
    const auto csv = csv_of(arguments);
    const auto run = support::run_ok(arguments + " --json");
    const auto json = nlohmann::json::parse(run.out);
    CHECK(json["columns"] == csv.columns());
    REQUIRE(json["rows"].size() == csv.size());
    for (std::size_t i = 0; i < csv.size(); ++i) {
        CHECK(json["rows"][i][2] == csv.number(i, "plane_albedo"));
    }
}

TEST_CASE("output to a file is the same as to standard output but for the command line",
          "[program]") {
    const support::TemporaryFolder folder;
    const std::string arguments = "phase rayleigh:1 --wavelengths 550 --angles 0:180:45";
    const auto direct = support::run_program(arguments);
    const auto filed = support::run_program(arguments + " -o " + (folder / "phase.csv"));
    CHECK(filed.exit_code == 0);
    CHECK(filed.out.empty());
    const auto body = [](const std::string& text) { return text.substr(text.find("# units")); };
    CHECK(body(support::read_file(folder / "phase.csv")) == body(direct.out));
    CHECK(folder.count() == 1);
}

TEST_CASE("messages name columns and keys of a file as they stand there", "[program]") {
    const support::TemporaryFolder folder;
    const auto error_of = [](const std::string& words) { return support::run_program(words).err; };
    const std::string moments = folder.write("m.csv", "l,chi,omega\n0,1,0.9\n");
    CHECK_THAT(error_of("albedo --base moments:" + moments),
               Catch::Contains("'omega'") && Catch::Contains("'wavelength_nm'"));
    const std::string sweep =
        folder.write("s.toml", "[scene]\nwavelengths = 550\n[axes]\nmu_in = 1\n");
    CHECK_THAT(error_of("sweep " + sweep + " -o " + (folder / "s.csv")),
               Catch::Contains("write wavelength_nm = "));
}

TEST_CASE("a file whose name promises another format gets a note", "[program]") {
    const support::TemporaryFolder folder;
    const auto note_of = [&](const std::string& name, const std::string& option = "") {
        const auto run = support::run_program("phase rayleigh:1 --wavelengths 550 --angles 0 -o " +
                                              (folder / name) + " " + option);
        CHECK(run.exit_code == 0);
        return run.err;
    };
    CHECK_THAT(note_of("p.npz"), Catch::Contains("p.npz' holds CSV") && Catch::Contains("export"));
    CHECK_THAT(note_of("p.json"), Catch::Contains("holds CSV; --json"));
    CHECK_THAT(note_of("p.csv", "--json"), Catch::Contains("holds JSON"));
    for (const char* name : {"p.csv", "p.txt", "p"})
        CHECK_THAT(note_of(name), !Catch::Contains("holds"));
    CHECK_THAT(note_of("p.json", "--json"), !Catch::Contains("holds"));
}
