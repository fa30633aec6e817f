// miebrdf brdf --stokes and its relatives.
#include <cmath>
#include <filesystem>

#include "tests/support/catch.h"
#include "tests/support/program_csv.h"
#include "tests/support/temporary_folder.h"

using namespace miebrdf;
using support::csv_of;
using Columns = std::vector<std::string>;

namespace {

const std::string kOneDirection = " --wavelengths 550 --mu-in 0.8 --mu-out 0.5 --azimuth 90";

}  // namespace

TEST_CASE("brdf --stokes prints Mueller matrices", "[program][polarisation]") {
    const auto three =
        csv_of("brdf --base rayleigh:0.9 --stokes 3 --quantity reflection" + kOneDirection);
    CHECK(three.columns() == Columns{"wavelength_nm", "mu_in", "mu_out", "azimuth_deg", "m11",
                                     "m12", "m13", "m21", "m22", "m23", "m31", "m32", "m33", "dolp",
                                     "aolp_deg"});
    // From another solver, to eight digits; the program's tolerance is 1e-3 of the largest.
    CHECK(std::abs(three.number(0, "m11") - 0.42948297) <= 2e-3);
    CHECK(std::abs(three.number(0, "m31") - 0.18648685) <= 2e-3);
    CHECK(std::abs(three.number(0, "dolp") - std::hypot(0.01182129, 0.18648685) / 0.42948297) <=
          5e-3);
    const auto four = csv_of("brdf --base rayleigh:0.9 --stokes 4" + kOneDirection);
    CHECK(four.columns().size() == 4 + 16 + 2);
    CHECK(std::abs(four.number(0, "m44") * M_PI + 0.13434483) <= 2e-3);
}

TEST_CASE("outputs say what was done about polarisation", "[program][polarisation]") {
    const auto said = [](const std::string& words) {
        const std::string out = support::run_program("brdf " + words + kOneDirection).out;
        const auto at = out.find("# polarisation: ");
        return at == std::string::npos ? std::string() : out.substr(at, out.find('\n', at) - at);
    };
    CHECK(said("--base hg:0.9,0.5 --stokes auto").empty());
    CHECK_THAT(said("--base rayleigh:0.9 --stokes auto"), Catch::Contains("3 components"));
    CHECK(said("--base rayleigh:0.9 --stokes 1").empty());
    CHECK_THAT(said("--base index:1.5,0.01,radius=20 --stokes auto"), Catch::Contains("left out"));
}

TEST_CASE("what does not go with polarisation is refused with the reason",
          "[program][polarisation][errors]") {
    struct Case {
        std::string words, reason;
    };
    const auto wrong = GENERATE(
        Case{"brdf --base rayleigh:0.9 --stokes 2" + kOneDirection, "auto, 1, 3, 4"},
        Case{"brdf --base rayleigh:0.9 --stokes 3 --quantity hdrf --diffuse-fraction 0.1" +
                 kOneDirection,
             "Mueller"},
        Case{"brdf --base rayleigh:0.9 --stokes 3 --component subsurface" + kOneDirection,
             "component"},
        Case{"brdf --base rayleigh:0.9 --roughness 0.3 --surface-index 1.5 --stokes 3" +
                 kOneDirection,
             "unpolarised"},
        Case{"export --base rayleigh:0.9 --roughness 0.3 --surface-index 1.5 --format pbsdf "
             "--wavelengths 550 -o /dev/null",
             "unpolarised"});
    const auto run = support::run_program(wrong.words);
    CAPTURE(wrong.words, run.err);
    CHECK(run.exit_code == 2);
    CHECK_THAT(run.err, Catch::Contains(wrong.reason));
}

TEST_CASE("polarisation is drawn", "[program][polarisation][plot]") {
    const support::TemporaryFolder folder;
    for (const char* kind : {"polarisation --incidence 30,60", "hemisphere --quantity dolp"}) {
        const std::string file = folder / "chart.svg";
        const auto run = support::run_program(std::string("plot ") + kind +
                                              " --base rayleigh:0.9 --wavelengths 550 -o " + file);
        CAPTURE(kind, run.err);
        CHECK(run.exit_code == 0);
        CHECK(std::filesystem::file_size(file) > 2000);
    }
}

TEST_CASE("auto is the default", "[program][polarisation]") {
    const std::string words = "brdf --base rayleigh:0.9 --no-comments" + kOneDirection;
    const std::string out = support::run_program(words).out;
    CHECK(out == support::run_program(words + " --stokes auto").out);
    CHECK(out != support::run_program(words + " --stokes 1").out);
}

TEST_CASE("exports hold what brdf --stokes prints", "[program][polarisation][export]") {
    const support::TemporaryFolder folder;
    const std::string scene = " --base rayleigh:0.9 --stokes 3" + kOneDirection;
    const std::string file = folder / "gas.csv";
    const auto run = support::run_ok("export --format csv" + scene + " -o " + file);
    const support::CsvOutput written(support::read_file(file));
    const auto printed = csv_of("brdf" + scene);
    REQUIRE(written.columns() == printed.columns());
    const double scale = printed.number(0, "m11");
    for (const std::string& column : printed.columns()) {
        if (column[0] != 'm' || column.starts_with("mu")) continue;
        CAPTURE(column);
        CHECK(std::abs(written.number(0, column) - printed.number(0, column)) <= 2e-3 * scale);
    }
}

TEST_CASE("pbsdf files are written, read back and checked", "[program][polarisation][export]") {
    const support::TemporaryFolder folder;
    const std::string file = folder / "gas.pbsdf";
    const std::string scene = " --base rayleigh:0.9 --wavelengths 500,600";
    const auto run =
        support::run_program("export --format pbsdf --resolution 16" + scene + " -o " + file);
    CAPTURE(run.err);
    CHECK(run.exit_code == 0);
    CHECK_THAT(run.err, Catch::Contains("read back"));
    const auto check = support::run_program("check " + file + scene);
    CAPTURE(check.out, check.err);
    CHECK(check.exit_code == 0);
}
