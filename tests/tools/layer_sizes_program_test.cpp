// Sizes of single layers, as every command that takes media reads and reports them.
#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/support/program_csv.h"
#include "tests/support/temporary_folder.h"
#include "tests/tools/one_line.h"

using namespace miebrdf;
using support::check_one_line;
using support::kUsage;

namespace {

const std::string kPair =
    " --base index:1.5,0.01,radius=2 --coat index:2.2,0.001,radius=0.2,variance=0.1@0.5"
    " --wavelengths 550";

/// The output of a run that went well, without the line that repeats its command.
std::string printed_by(const std::string& arguments) {
    const auto run = support::run_ok(arguments);
    CAPTURE(arguments);
    const std::size_t begin = run.out.find("# command: ");
    const std::size_t end = run.out.find('\n', begin);
    return begin == std::string::npos ? run.out
                                      : run.out.substr(0, begin) + run.out.substr(end + 1);
}

}  // namespace

TEST_CASE("outputs tell the sizes of every layer where they differ", "[program][sizes]") {
    const std::string wanted =
        "base index:1.5,0.01: power-law, effective radius 2 um, effective variance 0.2; "
        "coat 1 index:2.2,0.001: power-law, effective radius 0.2 um, effective variance 0.1; "
        "in a host of index 1";
    CHECK_THAT(printed_by("albedo" + kPair), Catch::Contains("# particles: " + wanted + "\n"));
    const std::string directions = " --mu-in 0.5 --mu-out 0.5 --azimuth 0";
    const auto json = nlohmann::json::parse(printed_by("brdf --json" + kPair + directions));
    CHECK(json["facts"]["particles"] == wanted);

    // Layers without particles are not listed, and sizes that agree are told once.
    CHECK_THAT(printed_by("albedo --base hg:0.9,0.5 --coat index:1.5,0.01,radius=2@1"),
               Catch::Contains("# particles: power-law, effective radius 2 um, effective variance "
                               "0.2, in a host of index 1\n"));
}

TEST_CASE("sizes written beside a medium give what the options give", "[program][sizes]") {
    for (const char* command :
         {"optics index:1.5,0.01", "phase index:1.5,0.01", "albedo --base index:1.5,0.01"}) {
        const std::string common = " --wavelengths 450,550";
        CAPTURE(command);
        CHECK(printed_by(std::string(command) + ",radius=2,variance=0.1,distribution=gamma" +
                         common) == printed_by(std::string(command) + common +
                                               " --effective-radius 2 --effective-variance 0.1 "
                                               "--size-distribution gamma"));
    }
}

TEST_CASE("plan lists a Mie run for each size of a material", "[program][sizes][plan]") {
    const std::string plan = printed_by(
        "plan albedo --base index:1.5,0.01,radius=2 --coat index:1.5,0.01,radius=0.2@0.5 "
        "--wavelengths 450,550 --no-cache");
    CHECK_THAT(plan, Catch::Contains("Mie theory for index:1.5,0.01,radius=2,") &&
                         Catch::Contains("Mie theory for index:1.5,0.01,radius=0.2,"));
}

TEST_CASE("exports and plots of layers with sizes of their own are written", "[program][sizes]") {
    const support::TemporaryFolder folder;
    const std::string table = folder / "pair.json";
    printed_by("export --format json" + kPair + " -o " + table);
    const auto written = nlohmann::json::parse(std::ifstream(table));
    CHECK_THAT(written["metadata"]["title"].get<std::string>(),
               Catch::Contains("index:2.2,0.001,radius=0.2,variance=0.1") &&
                   Catch::Contains("index:1.5,0.01,radius=2"));
    printed_by("export --format scattering --base index:1.5,0.01,radius=2 -o " +
               (folder / "s.npz"));
    printed_by("plot lobe" + kPair + " --compare index:1.5,0.01,radius=1 --tolerance 1e-2 -o " +
               (folder / "lobe.svg"));
    printed_by("plot phase index:1.5,0.01,radius=1 index:1.5,0.01,radius=2 -o " +
               (folder / "phase.svg"));
}

TEST_CASE("scene files take the sizes of layers, over those of the scene",
          "[program][sizes][scene]") {
    const support::TemporaryFolder folder;
    const std::string file = folder.write(
        "scene.toml",
        "wavelengths = 550\neffective-radius = 2\n[scene.a]\nbase = \"index:1.5,0.01\"\n"
        "coat = [\"index:2.2,0.001,radius=0.2,variance=0.1@0.5\"]\n[[result]]\n"
        "command = \"albedo\"\nscene = \"a\"\n");
    CHECK(printed_by("run --quiet " + file) == printed_by("albedo" + kPair));
    const std::string wrong =
        folder.write("wrong.toml", "[[result]]\ncommand = \"albedo\"\nbase = \"TiO2,raduis=1\"\n");
    check_one_line(support::run_program("run " + wrong), kUsage,
                   {"raduis", "did you mean radius?"});
}

TEST_CASE("sizes that cannot be are refused in one line", "[program][sizes][errors]") {
    check_one_line(support::run_program("albedo --base TiO2 --coat hg:0.9,0.5,radius=1@1"), kUsage,
                   {"hg:0.9,0.5,radius=1", "Mie theory"});
    check_one_line(support::run_program("albedo --base TiO2,radius=-1"), kUsage,
                   {"TiO2,radius=-1", "radius -1", "> 0"});
    // Errors that only the average over sizes finds name the layer, too.
    check_one_line(support::run_program("optics TiO2,radius=1e7 --wavelengths 550"), kUsage,
                   {"'TiO2,radius=10000000'", "radius 10000000 um", "--effective-variance 0.2"});
}
