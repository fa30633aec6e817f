// All commands have in common: help, plans, what did not converge, threads, scene files, notes.
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/support/catch.h"
#include "tests/support/program_csv.h"
#include "tests/support/temporary_folder.h"

using namespace miebrdf;
using support::csv_of;
using Columns = std::vector<std::string>;

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
        if (!is_missing) CHECK_THAT(version.out, Catch::StartsWith("miebrdf 1."));
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
    const auto run = support::run_ok(
        "plan brdf --base hg:0.9,0.7 --wavelengths 450,550 --mu-in 1 --mu-out 0.2,0.4 --json");
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
        const auto run = support::run_ok(command + coat);
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

TEST_CASE("densities of layers have their units", "[program]") {
    const std::string layers =
        "layers --substrate black --coat H2O_ice,radius=100@2cm --wavelengths 550 --layer-density ";
    const auto rows = [&](const std::string& density) {
        const auto run = support::run_ok(layers + density);
        return run.out.substr(run.out.find("\nwavelength_nm,"));
    };
    CHECK(rows("300kg/m3") == rows("300"));
    CHECK(rows("0.3g/cm3") == rows("300"));
    const std::string alone = rows("300");  // as the upper one of two, by its own word
    CHECK(rows("100 --coat H2O_ice,radius=100,layer-density=300@2cm")
              .find(alone.substr(alone.find("coat 1,") + 7)) != std::string::npos);
    const auto refused = support::run_program(layers + "300lb");
    CHECK(refused.exit_code != 0);
    CHECK(refused.err.find("kg/m3, g/cm3") != std::string::npos);
}

TEST_CASE("a coat of depth inf is the half-space, whatever is named below it", "[program]") {
    const std::string base = GENERATE("--base hg:0.9,0.5", "--base isotropic:0.99",
                                      "--base index:1.5,0.01 --effective-radius 0.5");
    const std::string medium = base.substr(7, base.find(" --", 7) - 7);
    const std::string rest = base.substr(7 + medium.size());
    const std::string coat = "--base TiO2 --coat hg:0.5,0.1@2 --coat " + medium + "@inf" + rest;
    const auto body = [](const std::string& arguments) {
        const auto run = support::run_ok(arguments);
        CAPTURE(arguments);
        return run.out.substr(run.out.find("\nwavelength_nm,"));
    };
    const std::string lobe = " --roughness 0.3 --surface-index 1.5,0";
    for (const std::string& command :
         {std::string("brdf --mu-in 0.3,1 --mu-out 0.2,0.9 --azimuth 0,120 "),
          std::string("brdf --coat-method first-order --mu-in 0.3 --mu-out 0.9 "),
          std::string("albedo --mu-in 0.3,1 "), "albedo --mu-in 0.3" + lobe + " "}) {
        // Averages of light with polarisation are others: which are taken follows what it changes.
        const std::string same = " --wavelengths 550 --stokes 1";
        CHECK(body(command + coat + same) == body(command + base + same));
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
    const auto run =
        support::run_ok("albedo --base hg:0.9,0.5 --wavelengths 550 --mu-in 0.5 --no-comments");
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

TEST_CASE("refusals of spheroids name the wavelength that was asked for", "[program][errors]") {
    // 3141.59 nm is the wavelength of spheres that stand in for these.
    const auto run = support::run_program(
        "albedo --wavelengths 550 --mu-in 1 --base "
        "index:1.5,0.01,radius=30,shape=spheroid,aspect=2,method=t-matrix");
    CHECK(run.exit_code == 2);
    CHECK_THAT(run.err, Catch::Contains("at 550 nm") && !Catch::Contains("3141.59"));
}
