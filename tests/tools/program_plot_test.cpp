#include <string>
#include <tuple>

#include "tests/support/catch.h"
#include "tests/support/program.h"
#include "tests/support/program_csv.h"
#include "tests/support/temporary_folder.h"

using namespace miebrdf::support;

TEST_CASE("every kind of plot comes out as SVG that names the command", "[program][plot]") {
    const TemporaryFolder folder;
    const std::string scene =
        " --base hg:0.9,0.5 --coat isotropic:0.5@0.2 --streams 16 --wavelengths 550";
    const auto [kind, options] = GENERATE_COPY(table<std::string, std::string>({
        {"lobe",
         scene +
             " --incidence 0,45 --component total,subsurface --roughness 0.3 --surface-index 1.5"},
        {"lobe", scene + " --log --decades 2 --cosine --compare isotropic:0.9"},
        {"hemisphere", scene + " --incidence 45 --log"},
        {"hemisphere", " --base hg:0.9,0.5 --streams 16"},  // one wavelength by default
        {"slice", " --base hg:0.9,0.5 --streams 16 --cells 20"},
        {"profile", " --base hg:0.9,0.5"},
        {"slice", scene + " --log --cells 30"},
        {"slice", scene + " --phi-d 0 --cells 20 --component subsurface"},
        {"lobe", scene + " --compare coat=isotropic:0.9@1 --compare 'depth=1; roughness=none'"},
        {"lobe", scene + " --vary depth=0.1,1 --theta-in 45"},
        {"spectrum", scene + ",600 --vary depth=0.1:1:3"},
        {"optics", " index:1.5,0.1,radius=0.1 --vary radius=0.1:0.3:3 --wavelengths 500,600"},
        {"phase-angle", scene + " --incidence 0,60 --radiance-factor"},
        {"profile", scene + " --mu-in 0.5,1"},
        {"profile", scene + " --incidence 0,60 --compare-coat-method first-order --azimuth 0"},
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
    CHECK((svg.find("<polyline") != std::string::npos || svg.find("<image") != std::string::npos));
    // Images are letters without meaning.
    std::string drawing = svg;
    for (auto image = drawing.find("base64,"); image != std::string::npos;
         image = drawing.find("base64,"))
        drawing.erase(image, drawing.find('"', image) - image);
    CHECK(drawing.find("nan") == std::string::npos);
    CHECK(drawing.find("inf") == std::string::npos);
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
        {"plot lobe --base isotropic:0.5 --compare depth=1 -o FOLDER/a.svg", 2, "no layer"},
        {"plot lobe --base isotropic:0.5 --compare no.toml -o FOLDER/a.svg", 3, "no.toml"},
        {"plot lobe --base isotropic:0.5 --vary depth=1:2:3 -o FOLDER/a.svg", 2, "no layer"},
        {"plot optics index:1.5,0.1 --vary depth=1:2:3 -o FOLDER/a.svg", 2, "radius"},
        {"plot slice --base isotropic:0.5 --wavelengths 450,550 -o FOLDER/a.svg", 2, "one"},
        {"plot slice --base isotropic:0.5 --wavelengths 550 --cells 1 -o FOLDER/a.svg", 2, "cells"},
        {"plot slice --base isotropic:0.5 --wavelengths 550 --component sheen -o FOLDER/a.svg", 2,
         "sheen"},
        {"plot profile --base isotropic:0.5 --wavelengths 550 --range 2,1 -o FOLDER/a.svg", 2,
         "ascending"},
        {"plot profile --base isotropic:0.5 --wavelengths 550 --compare-coat-method second-order "
         "-o FOLDER/a.svg",
         2, "second-order"},
        {"plot profile --base isotropic:0.5 --wavelengths 550 --points FOLDER/no.csv -o "
         "FOLDER/a.svg",
         3, "no.csv"},
        {"plot nk GaP -o FOLDER/no/a.svg", 3, "no"},
        {"plot phase rayleigh:1 --polar --decades 40 -o FOLDER/a.svg", 2, "decades"},
    }));
    std::string line = options;
    for (auto at = line.find("FOLDER"); at != std::string::npos; at = line.find("FOLDER")) {
        line.replace(at, 6, folder.path().string());
    }
    const ProgramRun run = run_program(line);
    CAPTURE(options, run.err);
    CHECK(run.exit_code == code);
    CHECK(run.err.find(wanted) != std::string::npos);
    CHECK(run.err.find('\n') == run.err.size() - 1);
    CHECK(folder.count() == 0);
}

TEST_CASE("a profile draws the points that belong to it", "[program][plot]") {
    const TemporaryFolder folder;
    const std::string scene = "--base hg:0.9,0.5 --streams 16 --tolerance 1e-2 --wavelengths 550";
    const std::string points = folder / "points.csv", chart = folder / "chart.svg";
    support::run_ok("brdf " + scene + " --mu-in 0.5 --mu-out 0.3,0.6 --azimuth 0,180 -o " + points);
    const std::string plot = "plot profile " + scene + " --points " + points + " -o " + chart;
    support::run_ok(plot + " --incidence 0,60");
    const std::string svg = read_file(chart);
    std::size_t circles = 0;
    for (auto at = svg.find("<circle"); at != std::string::npos; at = svg.find("<circle", at + 1))
        ++circles;
    CHECK(circles == 3);  // two values at azimuth 180, and the legend's
    const ProgramRun elsewhere = run_program(plot + " --incidence 30");
    CHECK(elsewhere.exit_code == 3);
    CHECK(elsewhere.err.find("none at 550 nm") != std::string::npos);
}

TEST_CASE("damaged points are refused with file and line", "[program][plot][errors]") {
    const TemporaryFolder folder;
    const auto [content, wanted] = GENERATE(table<std::string, std::string>({
        {"", "is empty"},
        {"mu_in,mu_out\n1,1\n", "no column of values"},
        {"wavelength_nm,mu_in,mu_out,azimuth_deg,brdf\n550,1,1,180\n", "points.csv:2: 4 fields"},
        {"# x\nwavelength_nm,mu_in,mu_out,azimuth_deg,brdf\n550,1,1,180,nan\n", "points.csv:3: "},
    }));
    const std::string points = folder.write("points.csv", content);
    const ProgramRun run =
        run_program("plot profile --base isotropic:0.5 --wavelengths 550 --points " + points +
                    " -o " + (folder / "a.svg"));
    CAPTURE(content, run.err);
    CHECK(run.exit_code == 3);
    CHECK(run.err.find(wanted) != std::string::npos);
}

TEST_CASE("a spectrum is drawn of wavelengths in any order", "[program][plot]") {
    const TemporaryFolder folder;
    const auto run = run_program("plot spectrum --base hg:0.9,0.4 -o " + (folder / "spectrum.svg"));
    CAPTURE(run.err);
    CHECK(run.exit_code == 0);
}

TEST_CASE("a chart speaks of scenes without the notation of options", "[program][plot]") {
    const TemporaryFolder folder;
    const std::string file = folder / "a.svg";
    const ProgramRun run = run_program(
        "plot spectrum --wavelengths 500,600 --base hg:0.9,0.5 --coat "
        "'index:1.5,0.1,radius=0.1@0.2' --compare depth=1 -o " +
        file);
    CAPTURE(run.err);
    REQUIRE(run.exit_code == 0);
    const std::string svg = read_file(file);
    const std::string shown = svg.substr(svg.find("</desc>"));
    CHECK(shown.find("radius=") == std::string::npos);
    CHECK(shown.find("hg:") == std::string::npos);
    CHECK(shown.find(">\u03c4 = 0.2<") != std::string::npos);
    CHECK(shown.find(">\u03c4 = 1<") != std::string::npos);
    CHECK(shown.find("any colour: spherical") != std::string::npos);
    CHECK(shown.find("Henyey-Greenstein") != std::string::npos);
}

TEST_CASE("degrees are the cosines that they are", "[program]") {
    const std::string scene = " --base hg:0.9,0.5 --wavelengths 550 --no-comments";
    const auto degrees = support::run_ok("brdf --theta-in 60 --view-zenith 0" + scene);
    CHECK(degrees.out == run_program("brdf --mu-in 0.5 --mu-out 1" + scene).out);
    CHECK(run_program("albedo --sun-zenith 60" + scene).out ==
          run_program("albedo --mu-in 0.5" + scene).out);
    const auto both = run_program("albedo --theta-in 60 --mu-in 0.5" + scene);
    CHECK(both.exit_code == 2);
    CHECK(both.err.find("one of them") != std::string::npos);
    CHECK(run_program("albedo --theta-in 90" + scene).exit_code == 2);
}
