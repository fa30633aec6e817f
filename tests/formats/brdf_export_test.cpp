#include "pipeline/formats/brdf_export.h"

#include <atomic>
#include <nlohmann/json.hpp>

#include <miebrdf/error.h>
#include "tests/support/catch.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test_material.h"

using namespace miebrdf;
using namespace miebrdf::exports;
namespace fs = std::filesystem;

TEST_CASE("every format is written, recognised by its content and close to the BRDF",
          "[exports][brdf_export]") {
    const support::TestMaterial material(support::seven_wavelengths(), 0.4);
    const support::TemporaryFolder folder;
    const std::string format =
        GENERATE("csv", "json", "npz", "exr", "pbrt", "rgl", "ssdd", "astm", "radiance", "klems");
    ExportOptions options;
    options.format = format;
    if (format == "rgl") options.resolution = 32;
    const auto files = export_brdf(material, options, folder / "file.any");
    CHECK(files.size() == (format == "rgl" ? 2 : 1));
    for (const auto& file : files) {
        const auto read = open_brdf_file(file.path.string());
        CHECK(read->format() == (format == "klems" ? "radiance" : format));
        CHECK(file.bytes == std::filesystem::file_size(file.path));
    }
    CHECK(folder.count() == files.size());
}

TEST_CASE("an rgl export that is stopped leaves neither of its two files",
          "[exports][brdf_export]") {
    const support::TestMaterial material(support::seven_wavelengths(), 0.4);
    const support::TemporaryFolder folder;
    ExportOptions options;
    options.format = "rgl";
    options.resolution = 32;
    std::atomic<bool> cancelled = false;
    std::size_t calls = 0, last = 0;
    RunControl control{.threads = 1};
    control.cancelled = &cancelled;
    control.progress = [&](const std::string&, std::size_t, std::size_t) {
        if (++calls == last) cancelled = true;
    };
    export_brdf(material, options, folder / "whole", control);
    CHECK(folder.count() == 2);
    // Shortly before the end the spectral file is long written.
    last = calls - 1;
    calls = 0;
    CHECK_THROWS_AS(export_brdf(material, options, folder / "stopped", control), Cancelled);
    CHECK(folder.count() == 2);
}

TEST_CASE("every format says what its numbers are and where they come from",
          "[exports][brdf_export]") {
    const support::TestMaterial material(support::seven_wavelengths(), 0.4);
    const support::TemporaryFolder folder;
    ExportOptions options;
    options.format = GENERATE(from_range(export_formats()));
    options.largest_error = 1e9;
    options.grid = {{0.5, 1.0}, {0.3, 1.0}, {0.0, 180.0}};
    CAPTURE(options.format);
    for (const auto& file : export_brdf(material, options, folder / "file")) {
        const bool beside = options.format == "merl";
        const std::string content =
            support::read_file(beside ? fs::path(file.path.string() + ".json") : file.path);
        for (const char* said :
             {"generator", "miebrdf test", "command", "miebrdf export", "units", "1/sr", "cosine",
              "azimuth_zero", "sources", "a closed form", "component", "total"}) {
            CHECK_THAT(content, Catch::Contains(said));
        }
        const bool coloured = options.format == "pbrt" || beside || options.format == "radiance" ||
                              options.format == "klems" || options.format == "exr";
        if (coloured) CHECK_THAT(content, Catch::Contains("R = 600 nm"));
    }
}

TEST_CASE("merl says in a file beside it what it has no room for", "[exports][brdf_export]") {
    const support::TestMaterial material(support::seven_wavelengths(), 0.4);
    const support::TemporaryFolder folder;
    ExportOptions options;
    options.format = "merl";
    export_brdf(material, options, folder / "paint.binary");
    const auto json = nlohmann::json::parse(support::read_file(folder / "paint.binary.json"));
    CHECK(json["units"] == "1/sr");
    CHECK(json["cosine"] == "not included");
    CHECK(json["wavelength_nm"].size() == 7);
    CHECK(json["sources"][0] == "a closed form");
    CHECK(json["command"] == "miebrdf export --base 'test \"material\"'");
}

TEST_CASE("a lobe too sharp for the resolution is refused with the error and what would do",
          "[exports][brdf_export]") {
    const support::SharpMaterial material(support::seven_wavelengths(), 0.12);
    const support::TemporaryFolder folder;
    ExportOptions options;
    options.format = "rgl";
    options.resolution = 8;
    CHECK_THROWS_AS(export_brdf(material, options, folder / "sharp.bsdf"), TooCoarse);
    CHECK_THROWS_WITH(export_brdf(material, options, folder / "sharp.bsdf"),
                      Catch::Contains("resolution 8 ") && Catch::Contains("--resolution ") &&
                          Catch::Contains("reaches"));
    CHECK(folder.count() == 0);
    // Too narrow to be met by random directions, and too narrow for any resolution.
    const support::SharpMaterial narrow(support::seven_wavelengths(), 0.02);
    options.format = "klems";
    options.resolution = 0;
    CHECK_THROWS_WITH(export_brdf(narrow, options, folder / "narrow.xml"),
                      Catch::Contains("near mirror") && Catch::Contains("no finer one"));
    options.format = "rgl";
    options.resolution = 8;
    options.largest_error = 100;
    CHECK(export_brdf(material, options, folder / "sharp.bsdf").size() == 2);
}

TEST_CASE("an unknown format is refused with the known ones", "[exports][brdf_export][errors]") {
    const support::TestMaterial material({550}, 0.4);
    ExportOptions options;
    options.format = "vrml";
    CHECK_THROWS_WITH(export_brdf(material, options, "x"),
                      Catch::Contains("vrml") && Catch::Contains("pbrt"));
}
