// Sweep files are read, or refused before anything runs.
#include <miebrdf/error.h>

#include <cmath>

#include "pipeline/sweep/layout.h"
#include "pipeline/sweep/parts.h"
#include "pipeline/sweep/sweep_file.h"
#include "tests/support/catch.h"
#include "tests/support/temporary_folder.h"

using namespace miebrdf;
using Catch::Contains;

namespace {

constexpr char kGoodSweep[] = R"(outputs = ["plane_albedo"]
[scene]
base = "{name},radius={r} + Au,radius=0.05,volume={f}"
host-index = 1.5
[axes]
f = [0.01, 0.1]
name = ["TiO2,volume=0.1", "SiO2,volume=0.1"]
r = "0.1:0.4:3 log"
mu_in = [0.5, 1]
wavelength_nm = [550, 600]
)";

std::string replaced(std::string text, const std::string& what, const std::string& with) {
    const std::size_t at = text.find(what);
    REQUIRE(at != std::string::npos);
    return text.replace(at, what.size(), with);
}

}  // namespace

TEST_CASE("axes that change Mie theory come first, in the order of the file", "[sweep]") {
    const support::TemporaryFolder folder;
    const auto sweep = sweep::read_sweep_file(folder.write("s.toml", kGoodSweep));
    REQUIRE(sweep.dimensions.size() == 3);
    CHECK(sweep.dimensions[0].name == "name");
    CHECK(sweep.dimensions[1].name == "r");
    CHECK(sweep.dimensions[2].name == "f");  // volume fractions mix what is there already
    CHECK(sweep.optical_dimensions == 2);
    CHECK(sweep.scenes() == 12);
    CHECK(sweep.scenes_per_group() == 2);

    const Request request = sweep::request_of(sweep, 11);
    CHECK(request.scene.base == medium("SiO2,volume=0.1,radius=0.4 + Au,radius=0.05,volume=0.1"));
    const auto layout = sweep::layout_of(sweep);
    CHECK(layout.record == 4);
    const sweep::Chunks chunks(sweep, layout);
    CHECK(chunks.size() == 2);  // 8 scenes and 4
    CHECK(chunks[1].first == 8);
    CHECK(chunks[1].count == 4);
}

TEST_CASE("zipped axes and samples of a file make one dimension", "[sweep]") {
    const support::TemporaryFolder folder;
    folder.write("samples.csv", "a,g\n0.1,0.2\n0.5,0.3\n0.5,0.1\n");
    const std::string tail = "wavelength_nm = 500\n";
    const auto from_file = sweep::read_sweep_file(folder.write(
        "file.toml",
        "outputs = [\"spherical_albedo\"]\n[scene]\nbase = \"hg:{a},{g}\"\ncoat = "
        "\"isotropic:0.5@{d}\"\n[axes]\ndraw = {file = \"samples.csv\"}\nd = [1, 2]\n" +
            tail));
    CHECK(from_file.scenes() == 6);
    const auto zipped = sweep::read_sweep_file(
        folder.write("zip.toml",
                     "outputs = [\"spherical_albedo\"]\ncombine = \"zip\"\n[scene]\nbase = "
                     "\"hg:{a},{g}\"\n[axes]\na = [0.1, 0.5]\ng = [0.2, 0.3]\n" +
                         tail));
    CHECK(zipped.scenes() == 2);
    CHECK(zipped.dimensions[0].name == "sample");
    CHECK(sweep::request_of(zipped, 1).scene.base == medium("hg:0.5,0.3"));
}

TEST_CASE("samples of a sequence are columns of one dimension", "[sweep]") {
    const support::TemporaryFolder folder;
    const std::string head = R"(outputs = ["spherical_albedo"]
[scene]
base = "hg:{a},{g}"
[axes]
wavelength_nm = 500
)";
    const auto sobol = sweep::read_sweep_file(
        folder.write("s.toml", head + "draw = {sobol = 5, a = \"0.2:0.6\", g = \"0:0.4\"}\n"));
    REQUIRE(sobol.dimensions.size() == 1);
    CHECK(sobol.dimensions[0].name == "draw");
    CHECK(sobol.dimensions[0].axes[0].name == "a");  // in the order of the file
    CHECK(sobol.dimensions[0].axes[1].numbers == std::vector<double>{0.2, 0.1, 0.3, 0.15, 0.35});
    const auto latin = sweep::read_sweep_file(folder.write(
        "l.toml",
        head + "draw = {latin-hypercube = 9, seed = 3, a = \"0.2:0.6\", g = \"0:0.4\"}\n"));
    CHECK(latin.scenes() == 9);
    const auto refused = [&](const std::string& line, const std::string& reason) {
        CHECK_THROWS_WITH(sweep::read_sweep_file(folder.write("b.toml", head + line + "\n")),
                          Contains(reason) && Contains("line 6"));
    };
    refused("draw = {sobol = 5, a = 3, g = \"0:0.4\"}", "50:1000 log");
    refused("draw = {sobol = 2.5, a = \"0.2:0.6\", g = \"0:0.4\"}", "whole number");
    refused("draw = {sobol = 2, latin-hypercube = 3, a = \"0:1\"}", "one of them");
    refused("draw = {sobol = 5, seed = 3, a = \"0.2:0.6\", g = \"0:0.4\"}", "seed");
}

TEST_CASE("files in words and on axes of a sweep file lie beside it", "[sweep]") {
    const support::TemporaryFolder folder;
    const std::string head = "wavelength_nm,single_scattering_albedo,g\n";
    folder.write("one.csv", head + "400,0.9,0.5\n700,0.9,0.5\n");
    folder.write("two.csv", head + "400,0.8,0.5\n700,0.8,0.5\n");
    const auto sweep =
        sweep::read_sweep_file(folder.write("s.toml", R"(outputs = ["spherical_albedo"]
[scene]
base = "hg:{file}"
[axes]
file = ["one.csv", "two.csv"]
wavelength_nm = 500
)"));
    for (const std::size_t scene : {0, 1}) {
        const auto found = sweep::look_up(sweep, scene);
        REQUIRE(found.refusals.empty());
        const Scene numbers{.base = medium(scene == 0 ? "hg:0.9,0.5" : "hg:0.8,0.5")};
        // Between two equal rows of the file an albedo is rounded.
        CHECK(std::abs(solve(found.request.scene, {500}).albedo({}).spherical_albedo[0] -
                       solve(numbers, {500}).albedo({}).spherical_albedo[0]) <= 1e-13);
    }
}

TEST_CASE("mistakes of a sweep file are named before anything runs", "[sweep][errors]") {
    const support::TemporaryFolder folder;
    struct Mistake {
        const char *what, *with, *said;
    };
    const std::vector<Mistake> mistakes = {
        {"{r}", "{radius}", "no axis 'radius'"},
        {"{r}", "{r", "braces"},
        {"radius={r}", "radius=0.1", "axis 'r' is not used"},
        {"host-index", "host-idnex", "did you mean host-index?"},
        {"outputs = [\"plane_albedo\"]", "outputs = [\"albedo\"]", "plane_albedo"},
        {"outputs", "output", "did you mean outputs?"},
        {"outputs = [\"plane_albedo\"]", "outputs = [\"brdf\"]", "needs an axis mu_out"},
        {"outputs = [\"plane_albedo\"]", "outputs = [\"spherical_albedo\"]", "'mu_in' is not used"},
        {"outputs = [\"plane_albedo\"]", "outputs = [\"colour\"]", "eight or more"},
        {"mu_in = [0.5, 1]", "mu_in = [0.5, 1.5]", "1.5"},
        {"mu_in = [0.5, 1]", "theta_in_deg = [10, 90]", "[0, 90)"},
        {"mu_in = [0.5, 1]", "mu_in = [0.5, 1]\ntheta_in_deg = 3", "same direction"},
        {"0.1:0.4:3 log", "0:0.4:3 log", "not positive"},
        {"[0.01, 0.1]", "[0.01, 0.1, 0.1]", "follows"},
        {"[0.01, 0.1]", "[0.01, \"x\"]", "numbers and texts"},
        {"\"SiO2,volume=0.1\"", "\"SiQ2x,volume=0.1\"", "SiQ2x"},
        {"wavelength_nm = [550, 600]\n", "", "needs wavelengths"},
        {"host-index = 1.5", "wavelengths = 550", "[axes]"},
        {"f = [0.01, 0.1]", "f = [0.01, 0.1]\nconverged = [1, 2]", "variable of this name"},
        {"outputs", "combine = \"zip\"\noutputs", "same length"},
        {"outputs", "combine = \"all\"\noutputs", "product, zip"},
        {"outputs", "chunk = 0\noutputs", "'chunk'"},
    };
    for (const Mistake& mistake : mistakes) {
        CAPTURE(mistake.what, mistake.with);
        const std::string file =
            folder.write("bad.toml", replaced(kGoodSweep, mistake.what, mistake.with));
        CHECK_THROWS_WITH(sweep::read_sweep_file(file), Contains(mistake.said));
    }
    CHECK_THROWS_AS(sweep::read_sweep_file(folder / "none.toml"), InputError);
    CHECK_THROWS_WITH(sweep::read_sweep_file(folder.write("b.toml", "outputs = [\n")),
                      Contains("line"));
}
