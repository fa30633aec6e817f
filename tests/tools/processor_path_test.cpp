// The program along each processor path that this build has and this machine can run
// (tools/cmake/MiebrdfProcessorPaths.cmake). Builds for one path run the first three cases only.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include <miebrdf/processor_path.h>
#include "tests/support/catch.h"
#include "tests/support/program.h"
#include "tests/tools/one_line.h"
#include "tools/miebrdf/processor_path.h"

using namespace miebrdf;

namespace {

std::string forced(const std::string& path) {
    return fmt::format("{}={}", program::kPathVariable, path);
}

support::CsvOutput csv_along(const std::string& path, const std::string& arguments) {
    const auto run = support::run_program(arguments, forced(path));
    CAPTURE(arguments, run.err);
    // Large clear spheres are noisy at single angles; what does not converge is written all the
    // same.
    REQUIRE((run.exit_code == 0 || run.exit_code == 4));
    return support::CsvOutput(run.out);
}

/// The base path and the one of this name; empty, with the reason said, where it cannot be run.
std::vector<std::string> paths_to_compare(const std::string& name) {
    const auto paths = program::processor_paths();
    const auto found = std::find_if(paths.begin(), paths.end(),
                                    [&](const auto& path) { return path.name == name; });
    if (found == paths.end() || paths.size() == 1) {
        WARN("skipped: this build has no libraries for " << name);
        return {};
    }
    if (!found->runs_here) {
        WARN("skipped: this processor cannot run " << name);
        return {};
    }
    return {paths.front().name, name};
}

/// The largest difference of the column "brdf", relative to the largest value at the same
/// wavelength and incidence.
double brdf_difference(const support::CsvOutput& a, const support::CsvOutput& b) {
    REQUIRE(a.size() == b.size());
    REQUIRE(a.size() > 0);
    const auto incidence = [&](std::size_t row) {
        return a.text(row, "wavelength_nm") + "," + a.text(row, "mu_in");
    };
    std::map<std::string, double> largest;
    for (std::size_t row = 0; row < a.size(); ++row) {
        double& scale = largest[incidence(row)];
        scale = std::max(scale, std::abs(a.number(row, "brdf")));
    }
    double worst = 0;
    for (std::size_t row = 0; row < a.size(); ++row) {
        const double error = std::abs(a.number(row, "brdf") - b.number(row, "brdf"));
        worst = std::max(worst, error / largest[incidence(row)]);
    }
    return worst;
}

/// A hundredth of the tolerance that all of these are computed to: the paths round differently, and
/// what they decide by rounded numbers must not show.
void compare_with_base(const std::string& name) {
    const auto paths = paths_to_compare(name);
    if (paths.empty()) return;
    constexpr double kBound = 1e-3 / 100;
    const std::string directions =
        " --mu-in 0.1,0.5,1 --mu-out 0.05:1:0.19 --azimuth 0:180:45 --tolerance 1e-3";
    for (const std::string& scene :
         {std::string("--base hg:0.99,0.75 --coat hg:0.5,-0.3@0.4"),
          std::string("--base TiO2,radius=2 --coat 'AlGaAs7,radius=0.5@0.1[grey]' --roughness 0.3 "
                      "--wavelengths 450,620"),
          std::string("--base TiO2 --wavelengths 550"),
          std::string("--base TiO2 --coat AlGaAs7@0.1 --wavelengths 550"),
          std::string("--base TiO2,radius=0.13,volume=15%,variance=0.1 --host-index 1.5 "
                      "--boundary rough:0.2 --wavelengths 500")}) {
        CAPTURE(scene);
        const std::string words = "brdf " + scene + directions;
        CHECK(brdf_difference(csv_along(paths[0], words), csv_along(paths[1], words)) <= kBound);
    }
    const std::string optics =
        "optics index:1.46,1e-5 --effective-radius 20 --wavelengths 500,600 "
        "--moments 64 --mie-tolerance 1e-3";
    const auto a = csv_along(paths[0], optics), b = csv_along(paths[1], optics);
    REQUIRE(a.size() == 2);
    for (const std::string& column : a.columns()) {  // all of order 1, as the tolerance is
        if (column.rfind("chi_", 0) != 0 && column != "single_scattering_albedo") continue;
        CAPTURE(column);
        for (std::size_t row = 0; row < a.size(); ++row)
            CHECK(std::abs(a.number(row, column) - b.number(row, column)) <= kBound);
    }
}

}  // namespace

TEST_CASE("the option --version tells the processor path, which the variable chooses",
          "[program][paths]") {
    const auto paths = program::processor_paths();
    REQUIRE(!paths.empty());
    const std::string line = "processor path: ";
    CHECK_THAT(support::run_program("--version").out,
               Catch::Contains(line + std::string(processor_path())));
    for (const auto& path : paths) {
        CAPTURE(path.name);
        const auto run = support::run_program("--version", forced(path.name));
        if (path.runs_here) {
            CHECK(run.exit_code == 0);
            CHECK_THAT(run.out, Catch::Contains(line + path.name));
        } else {
            support::check_one_line(run, support::kUsage,
                                    {program::kPathVariable, path.name, "cannot run", "allowed"});
        }
    }
}

TEST_CASE("a processor path that is not there is refused with those that are",
          "[program][paths][errors]") {
    support::check_one_line(
        support::run_program("albedo --base isotropic:1", forced("z80")), support::kUsage,
        {program::kPathVariable, "'z80'", "allowed: " + program::processor_paths().front().name});
}

TEST_CASE("what few commands need is not loaded when the program starts", "[program]") {
    // The loader lists what it would load; sanitizers and tests add libraries of their own.
    const auto run = support::run_program("--version", "LD_TRACE_LOADED_OBJECTS=1");
    CHECK_THAT(run.out, Catch::Contains("libtbb.so"));
    for (const char* library : {"librsvg", "libcairo", "libnetcdf", "libembree"})
        CHECK_THAT(run.out, !Catch::Contains(library));
}

TEST_CASE("results along x86-64-v2 agree with those along x86-64", "[program][paths]") {
    compare_with_base("x86-64-v2");
}

TEST_CASE("results along x86-64-v3 agree with those along x86-64", "[program][paths]") {
    compare_with_base("x86-64-v3");
}

TEST_CASE("results along x86-64-v4 agree with those along x86-64", "[program][paths]") {
    compare_with_base("x86-64-v4");
}
