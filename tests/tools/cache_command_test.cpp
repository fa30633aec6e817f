// miebrdf cache: what its user is told, where it lies, and that forgetting loses nothing else.
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/support/program_csv.h"
#include "tests/support/temporary_folder.h"
#include "tests/tools/one_line.h"

using namespace miebrdf;

namespace {

const std::string kWork =
    "albedo --base index:1.5,0.01 --effective-radius 0.5 --mu-in 1 --wavelengths 500,550 --stokes "
    "1";

support::CsvOutput info(const std::string& environment) {
    const auto run = support::run_ok("cache info", environment);
    CAPTURE(environment);
    support::CsvOutput table(run.out);
    REQUIRE(table.size() == 1);
    return table;
}

std::string rows(const support::ProgramRun& run) {
    REQUIRE(run.exit_code == 0);
    return run.out.substr(run.out.find("wavelength_nm,mu_in"));
}

}  // namespace

TEST_CASE("cache info counts what was computed, cache clear forgets it", "[program][cache]") {
    const support::TemporaryFolder folder;
    const std::string here = "XDG_CACHE_HOME='" + folder.path().string() + "'";
    const auto empty = info(here);
    CHECK(empty.text(0, "file") == folder / "miebrdf/results.sqlite");
    CHECK(empty.text(0, "usable") == "yes");
    CHECK(empty.number(0, "entries") == 0);
    CHECK(empty.number(0, "bytes") == 0);

    const std::string first = rows(support::run_program(kWork, here));
    // For each wavelength the single scattering of the medium and the layers.
    const auto full = info(here);
    CHECK(full.number(0, "entries") == 4);
    CHECK(full.number(0, "bytes") > 0);
    CHECK(full.number(0, "bytes") <= full.number(0, "limit_bytes"));
    CHECK(rows(support::run_program(kWork, here)) == first);
    CHECK(info(here).number(0, "entries") == 4);

    const auto clear = support::run_program("cache clear", here);
    CHECK(clear.exit_code == 0);
    CHECK(clear.out.empty());
    CHECK_THAT(clear.err, Catch::Contains("forgot 4 results in " + (folder / "miebrdf")));
    CHECK(info(here).number(0, "entries") == 0);
    CHECK(rows(support::run_program(kWork, here)) == first);

    const auto json = nlohmann::json::parse(support::run_program("cache info --json", here).out);
    CHECK(json["rows"][0][2] == 4);
}

TEST_CASE("a run with --no-cache leaves nothing behind", "[program][cache]") {
    const support::TemporaryFolder folder;
    const std::string here = "XDG_CACHE_HOME='" + folder.path().string() + "'";
    rows(support::run_program(kWork + " --no-cache", here));
    CHECK(folder.count() == 0);
}

TEST_CASE("the cache lies where XDG says, else under HOME, else among temporary files",
          "[program][cache]") {
    const support::TemporaryFolder folder;
    const std::string place = folder.path().string();
    // A path that is not absolute is to be ignored (XDG Base Directory Specification 0.8).
    CHECK(info("XDG_CACHE_HOME=relative HOME='" + place + "'").text(0, "file") ==
          folder / ".cache/miebrdf/results.sqlite");
    CHECK(info("XDG_CACHE_HOME= HOME= TMPDIR='" + place + "'").text(0, "file") ==
          folder / "miebrdf/results.sqlite");
}

TEST_CASE("without a place for the cache everything is computed, and info says so",
          "[program][cache][errors]") {
    const support::TemporaryFolder folder;
    folder.write("miebrdf", "a file where the folder should be");
    const std::string nowhere = "XDG_CACHE_HOME='" + folder.path().string() + "'";
    CHECK(info(nowhere).text(0, "usable") == "no");
    CHECK(info(nowhere).number(0, "entries") == 0);
    CHECK(rows(support::run_program(kWork, nowhere)) == rows(support::run_program(kWork)));
    CHECK(support::run_program("cache clear", nowhere).exit_code == 0);
    CHECK(support::read_file(folder / "miebrdf") == "a file where the folder should be");
}

TEST_CASE("a file that is no cache is replaced by one", "[program][cache][errors]") {
    const support::TemporaryFolder folder;
    std::filesystem::create_directory(folder / "miebrdf");
    folder.write("miebrdf/results.sqlite", std::string(5000, 'x'));
    const std::string here = "XDG_CACHE_HOME='" + folder.path().string() + "'";
    CHECK(rows(support::run_program(kWork, here)) == rows(support::run_program(kWork)));
    CHECK(info(here).number(0, "entries") == 4);
}

TEST_CASE("cache without a verb, or with another, is refused", "[program][cache][errors]") {
    support::check_one_line(support::run_program("cache"), support::kUsage, {"subcommand"});
    support::check_one_line(support::run_program("cache claer"), support::kUsage,
                            {"claer", "clear"});
}
