// The program's contract: names, columns, formats and a few values known from outside.
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

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
    const auto run = support::run_program(arguments + " --json");
    REQUIRE(run.exit_code == 0);
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

TEST_CASE("every command explains itself with an example and tells its version", "[program]") {
    std::vector<std::string> commands = support::commands_in(support::run_program("--help").out);
    CHECK(commands.size() >= 16);
    commands.insert(commands.end(), {"materials nk", "plan brdf", "plan albedo", "plot nk",
                                     "plot slice", "cache info", "cache clear"});
    for (const std::string& command : commands) {
        CAPTURE(command);
        const auto help = support::run_program(command + " --help");
        CHECK(help.exit_code == 0);
        const bool is_missing = help.out.find("not in this build") != std::string::npos;
        if (!is_missing) CHECK_THAT(help.out, Catch::Contains("Example"));
        const auto version = support::run_program(command + " --version");
        CHECK((version.exit_code == 0 || is_missing));
        if (!is_missing) CHECK_THAT(version.out, Catch::StartsWith("miebrdf 0."));
    }
}

TEST_CASE("the page about the command line has every command", "[program][docs]") {
    const std::string page =
        support::read_file(MIEBRDF_REFERENCE_DIR "/../../docs/command-line.md");
    for (const std::string& command : support::commands_in(support::run_program("--help").out)) {
        CAPTURE(command);
        CHECK_THAT(page, Catch::Contains("| `miebrdf " + command));
    }
}

TEST_CASE("render is known in every build: it draws, or says which packages it needs",
          "[program]") {
    const auto help = support::run_program("render --help");
    CHECK(help.exit_code == 0);
    const auto run =
        support::run_program("render --object no_such.obj --base hg:0.9,0.5 -o no.png");
    if (help.out.find("not in this build") == std::string::npos) {
        CHECK(run.exit_code == 3);
        CHECK_THAT(run.err, Catch::Contains("no_such.obj"));
    } else {
        CHECK(run.exit_code == 2);
        CHECK_THAT(run.err, Catch::Contains("libembree-dev"));
    }
}

TEST_CASE("a plan names the work and what is left out, for options and for scene files",
          "[program][plan]") {
    const auto run = support::run_program(
        "plan brdf --base hg:0.9,0.7 --wavelengths 450,550 --mu-in 1 --mu-out 0.2,0.4 --json");
    REQUIRE(run.exit_code == 0);
    const auto json = nlohmann::json::parse(run.out);
    CHECK(json["columns"] == Columns{"result", "action", "name", "detail", "jobs", "seconds"});
    std::map<std::string, std::string> actions;
    for (const auto& row : json["rows"]) actions[row[2]] = row[1];
    CHECK(actions["radiative transfer"] == "compute");
    for (const char* rule : {"zenith", "same wavelength", "analytic medium", "no surface"}) {
        CHECK(actions[rule] == "leave out");
    }
    const support::TemporaryFolder folder;
    const std::string file =
        folder.write("scene.toml",
                     "base = \"isotropic:0.5\"\n"
                     "[[result]]\ncommand = \"albedo\"\noutput = \"x.csv\"\n"
                     "[[result]]\ncommand = \"brdf\"\nmu-in = 1\nmu-out = 1\n");
    const auto scene = csv_of("plan " + file);
    CHECK(scene.text(0, "result") == "1 albedo");
    CHECK(scene.text(scene.size() - 1, "result") == "2 brdf");
    CHECK(folder.count() == 1);  // nothing was computed
    const auto drawdown = csv_of("plan albedo --coat hg:0.9,0.5@1 --over black,white");
    CHECK(drawdown.text(0, "result") == "albedo over black");
    CHECK(drawdown.text(0, "detail").find("1 order of 1 layer") != std::string::npos);
    CHECK(drawdown.text(drawdown.size() - 1, "result") == "albedo over lambert:0.8");
    CHECK(support::run_program("plan").exit_code == 2);
    CHECK(support::run_program("plan brdf").exit_code == 2);
}

TEST_CASE("what did not converge is marked in the file, row by row of the report", "[program]") {
    // Two nodes for a forward peak.
    const auto run = support::run_program(
        "brdf --base hg:0.99,0.9 --streams 2 --mu-in 0.1,0.5 --mu-out 0.1,0.5 --wavelengths 550 "
        "--json");
    CHECK(run.exit_code == 4);
    const auto json = nlohmann::json::parse(run.out);
    CHECK(json["facts"].contains("not converged"));
    const auto& report = json["report"][0];
    CHECK(report["converged"] == "no");
    CHECK(report["error_estimate"] > 1e-3);
    CHECK(report["reciprocity_defect"] <= 1e-10);
    CHECK(report["largest_albedo"] <= 1.0);
    CHECK(report.contains("least_value"));
}

TEST_CASE("results are the same bits for any number of threads", "[program]") {
    const std::string arguments =
        "brdf --base hg:0.9,0.7 --coat hg:0.5,0.2@0.3 --wavelengths 400:700:50 --mu-in 0.3,0.9 "
        "--mu-out 0.2,1 --azimuth 0,120";
    const auto body = [&](const char* threads) {
        const auto run = support::run_program(arguments + std::string(" --threads ") + threads);
        return run.out.substr(run.out.find("wavelength_nm,"));
    };
    const std::string one = body("1");
    CHECK(body("2") == one);
    CHECK(body("7") == one);
}

TEST_CASE("a scene file gives the bits of its commands run one by one, whatever they share",
          "[program][scene]") {
    const support::TemporaryFolder folder;
    const std::string directions =
        " --wavelengths 450,550 --mu-in 0.4 --mu-out 0.3,0.9 --azimuth 0,60";
    const std::string spheres =
        " --base index:1.5,0.01 --effective-radius 2 --roughness 0.3 --no-cache";
    const std::vector<std::string> coats = {"hg:0.8,0.5@0.2", "hg:0.8,0.5@1"};
    std::string text =
        "base = \"index:1.5,0.01\"\neffective-radius = 2\nroughness = 0.3\n"
        "surface-index = [1.5, 0.0]\nthreads = 5\n"
        "wavelengths = [450, 550]\nmu-in = 0.4\nmu-out = [0.3, 0.9]\nazimuth = [0, 60]\n";
    for (const std::string& coat : coats) {
        text += "[[result]]\ncommand = \"brdf\"\ncoat = \"" + coat + "\"\n";
    }
    const std::string file = folder.write("scene.toml", text);
    const auto values_of = [](const std::string& csv) {
        std::string values;
        std::istringstream lines(csv);
        for (std::string line; std::getline(lines, line);) {
            if (!line.empty() && line[0] != '#') values += line + "\n";
        }
        return values;
    };
    std::string one_by_one;
    const std::string command = "brdf" + spheres + directions + " --surface-index 1.5,0 --coat ";
    for (const std::string& coat : coats) {
        const auto run = support::run_program(command + coat);
        REQUIRE(run.exit_code == 0);
        one_by_one += values_of(run.out);
    }
    for (const char* threads : {"1", "2", "7"}) {
        const auto run =
            support::run_program("run " + file + " --no-cache --threads " + std::string(threads));
        CAPTURE(run.err);
        CHECK(run.exit_code == 0);
        CHECK(values_of(run.out) == one_by_one);
    }
    const auto plan = csv_of("plan " + file + " --no-cache");
    std::map<std::string, std::string> omitted;  // rule: result that obeys it last
    for (std::size_t row = 0; row < plan.size(); ++row) {
        if (plan.text(row, "action") == "leave out")
            omitted[plan.text(row, "name")] = plan.text(row, "result");
    }
    CHECK(omitted["same spheres"] == "2 brdf");
}

TEST_CASE("a coat of depth inf is the half-space, whatever is named below it", "[program]") {
    const std::string base = GENERATE("--base hg:0.9,0.5", "--base isotropic:0.99",
                                      "--base index:1.5,0.01 --effective-radius 0.5");
    const std::string medium = base.substr(7, base.find(" --", 7) - 7);
    const std::string rest = base.substr(7 + medium.size());
    const std::string coat = "--base TiO2 --coat hg:0.5,0.1@2 --coat " + medium + "@inf" + rest;
    const auto body = [](const std::string& arguments) {
        const auto run = support::run_program(arguments);
        CAPTURE(arguments, run.err);
        REQUIRE(run.exit_code == 0);
        return run.out.substr(run.out.find("\nwavelength_nm,"));
    };
    const std::string lobe = " --roughness 0.3 --surface-index 1.5,0";
    for (const std::string& command :
         {std::string("brdf --mu-in 0.3,1 --mu-out 0.2,0.9 --azimuth 0,120 "),
          std::string("brdf --coat-method first-order --mu-in 0.3 --mu-out 0.9 "),
          std::string("albedo --mu-in 0.3,1 "), "albedo --mu-in 0.3" + lobe + " "}) {
        CHECK(body(command + coat + " --wavelengths 550") ==
              body(command + base + " --wavelengths 550"));
    }
    const auto plan = csv_of("plan albedo " + coat);
    bool hidden = false;
    for (std::size_t row = 0; row < plan.size(); ++row)
        hidden = hidden || plan.text(row, "name") == "hidden layers";
    CHECK(hidden);
}

TEST_CASE("what surprises is said: default sizes on stderr, no absorption in a note",
          "[program][notes]") {
    const std::string scene = "albedo --wavelengths 550 --mu-in 0.5 --substrate lambert:1 --coat ";
    const auto surprising = support::run_program(scene + "index:1.5@0.1 --mie-tolerance 0.1");
    CAPTURE(surprising.err, surprising.out);
    CHECK_THAT(surprising.err, Catch::Contains("effective radius 50 um"));
    CHECK_THAT(surprising.out, Catch::Contains("# note: nothing absorbs"));
    const auto plain = support::run_program(scene + "index:1.5,0.1,radius=100nm@0.1");
    CHECK(plain.err.empty());
    CHECK(plain.out.find("nothing absorbs") == std::string::npos);
    const auto same = support::run_program(scene + "index:1.5,0.1@0.1 --effective-radius 100nm");
    CHECK(same.err.empty());
}

TEST_CASE("without comments a table is its header and rows", "[program]") {
    const auto run = support::run_program(
        "albedo --base hg:0.9,0.5 --wavelengths 550 --mu-in 0.5 --no-comments");
    REQUIRE(run.exit_code == 0);
    CHECK(run.out.rfind("wavelength_nm,mu_in,", 0) == 0);
    CHECK(run.out.find('#') == std::string::npos);
}

TEST_CASE("the option --color is --colour", "[program]") {
    const std::string scene = "albedo --base hg:0.9,0.5 --wavelengths 400:700:20 ";
    const auto row = [](const support::ProgramRun& run) {
        return run.out.substr(run.out.find("\nquantity,"));
    };
    CHECK(row(support::run_program(scene + "--color d65")) ==
          row(support::run_program(scene + "--colour d65")));
}
