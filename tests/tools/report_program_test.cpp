// miebrdf report: pages that hold what was asked for, and refusals before any work.
#include <algorithm>
#include <fstream>
#include <regex>
#include <string>
#include <tuple>

#include "tests/support/catch.h"
#include "tests/support/program.h"
#include "tests/support/temporary_folder.h"

using namespace miebrdf::support;

TEST_CASE("a report is one file that loads nothing and says what it shows", "[program][report]") {
    const TemporaryFolder folder;
    const std::string scene = folder.write(
        "paint.toml",
        "base = \"hg:0.9,0.5\"\ncoat = [\"isotropic:0.5@0.2\"]\nwavelengths = \"450,550,650\"\n"
        "[[result]]\ncommand = \"albedo\"\n[[result]]\ncommand = \"albedo\"\ncoat = []\n");
    const std::string file = folder / "page.html";
    const ProgramRun run =
        run_program("report " + scene + " " + scene + "#2 --title 'A <b>' --json -o " + file);
    CAPTURE(run.err);
    REQUIRE(run.exit_code == 0);
    CHECK(run.out.find("\"interpolation_error\"") != std::string::npos);
    const std::string page = read_file(file);
    CHECK(page.find("<title>A &lt;b&gt;</title>") != std::string::npos);
    CHECK(page.find("@DATA@") == std::string::npos);
    CHECK_FALSE(
        std::regex_search(page.substr(0, 4000), std::regex("(src|href)\\s*=\\s*\"(https?:)?//")));
    CHECK(page.size() < 1'000'000);
}

TEST_CASE("a wavelength in micrometres is recognised", "[program][errors]") {
    const ProgramRun run = run_program("albedo --base TiO2 --wavelengths 0.55");
    CHECK(run.exit_code == 3);
    CHECK(run.err.find("0.55um") != std::string::npos);
}

TEST_CASE("a family is solved for each of its values", "[program][report]") {
    const TemporaryFolder folder;
    const std::string scene =
        " --base hg:0.9,0.5 --coat isotropic:0.5@0.2 --wavelengths 450,550 --quiet -o " +
        (folder / "page.html");
    CHECK(run_program("report --vary depth=0:1:3" + scene).exit_code == 0);
    const std::size_t three = read_file(folder / "page.html").size();
    CHECK(run_program("report --vary depth=0:1:9" + scene).exit_code == 0);
    CHECK(read_file(folder / "page.html").size() > three);
}

TEST_CASE("bad reports are refused with one line and no file", "[program][report][errors]") {
    const TemporaryFolder folder;
    const auto [options, wanted] = GENERATE(table<std::string, std::string>({
        {"", "report needs a scene"},
        {"--base hg:0.9,0.5 --vary depth=0:1:3", "no layer"},
        {"--base hg:0.9,0.5 --vary depth=0:1", "NAME=FROM:TO:COUNT"},
        {"--base hg:0.9,0.5 --vary roughness=0.1:0.3:1", "COUNT from 2 to 33"},
        {"--base hg:0.9,0.5 --vary roughness=0.1:0.3:2.5", "COUNT from 2 to 33"},
        {"--base hg:0.9,0.5 --vary radius=1:2:3", "no particles"},
        {"--base TiO2 --vary concentration=1:2:3", "has no amount"},
        {"--base TiO2 --vary sheen=1:2:3", "sheen"},
        {"missing.toml", "missing.toml"},
    }));
    const std::string file = folder / "page.html";
    const ProgramRun run = run_program("report " + options + " -o " + file);
    CAPTURE(options, run.err);
    CHECK(run.exit_code != 0);
    CHECK(run.err.find(wanted) != std::string::npos);
    CHECK(std::count(run.err.begin(), run.err.end(), '\n') == 1);
    CHECK_FALSE(std::ifstream(file).good());
}
