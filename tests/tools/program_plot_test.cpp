#include <string>
#include <tuple>

#include "tests/support/catch.h"
#include "tests/support/program.h"
#include "tests/support/temporary_folder.h"

using namespace miebrdf::support;

TEST_CASE("every kind of plot comes out as SVG that names the command", "[program][plot]") {
    const TemporaryFolder folder;
    const std::string scene =
        " --base hg:0.9,0.5 --coat isotropic:0.5@0.2 --streams 8 --wavelengths 550";
    const auto [kind, options] = GENERATE_COPY(table<std::string, std::string>({
        {"lobe",
         scene +
             " --incidence 0,45 --component total,subsurface --roughness 0.3 --surface-index 1.5"},
        {"lobe", scene + " --log --decades 2 --cosine --compare isotropic:0.9"},
        {"hemisphere", scene + " --incidence 45 --log"},
        {"spectrum", scene + ",600,650 --incidence 60"},
        {"nk", " GaP SiO2"},
        {"optics", " hg:0.9,0.5 isotropic:0.3 --wavelengths 400,500"},
        {"phase", " hg:0.9,0.5 rayleigh:1"},
        {"phase", " hg:0.9,0.5 --polar --decades 3"},
    }));
    const std::string file = folder / "chart.svg";
    const ProgramRun run = run_program("plot " + kind + options + " -o " + file);
    CAPTURE(kind, options, run.err);
    REQUIRE(run.exit_code == 0);
    CHECK(run.out.empty());
    const std::string svg = read_file(file);
    CHECK(svg.find("</svg>") != std::string::npos);
    CHECK(svg.find("<desc>miebrdf plot " + kind) != std::string::npos);
    CHECK(svg.find("<polyline") + svg.find("<polygon") != 2 * std::string::npos);
    CHECK(svg.find("nan") == std::string::npos);
    CHECK(svg.find("inf") == std::string::npos);
}

TEST_CASE("without a file the SVG goes to standard output", "[program][plot]") {
    const ProgramRun run = run_program("plot phase rayleigh:1 --title 'P of <air>'");
    CHECK(run.exit_code == 0);
    CHECK(run.out.find("<title>P of &lt;air&gt;</title>") != std::string::npos);
}

TEST_CASE("bad plots are refused before any work, with one line and no file",
          "[program][plot][errors]") {
    const TemporaryFolder folder;
    const auto [options, code, wanted] = GENERATE(table<std::string, int, std::string>({
        {"plot nk GaP -o FOLDER/a.gif", 2, ".svg, .png"},
        {"plot nk Unobtainium -o FOLDER/a.svg", 3, "Unobtainium"},
        {"plot nk isotropic:0.5 -o FOLDER/a.svg", 2, "no refractive index"},
        {"plot lobe --base isotropic:0.5 --wavelengths 550 --component sheen -o FOLDER/a.svg", 2,
         "sheen"},
        {"plot lobe --base isotropic:0.5 --wavelengths 550 --component surface -o FOLDER/a.svg", 2,
         "--roughness"},
        {"plot lobe --base isotropic:0.5 --wavelengths 550 --incidence 95 -o FOLDER/a.svg", 2,
         "95"},
        {"plot hemisphere --base isotropic:0.5 --wavelengths 450,550 -o FOLDER/a.svg", 2, "one"},
        {"plot nk GaP -o FOLDER/no/a.svg", 3, "no"},
        {"plot phase rayleigh:1 --polar --decades 40 -o FOLDER/a.svg", 2, "decades"},
    }));
    std::string line = options;
    if (const auto at = line.find("FOLDER"); at != std::string::npos) {
        line.replace(at, 6, folder.path().string());
    }
    const ProgramRun run = run_program(line);
    CAPTURE(options, run.err);
    CHECK(run.exit_code == code);
    CHECK(run.err.find(wanted) != std::string::npos);
    CHECK(run.err.find('\n') == run.err.size() - 1);
    CHECK(folder.count() == 0);
}
