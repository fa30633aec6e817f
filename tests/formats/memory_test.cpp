// How much memory an export takes beyond the BRDF itself: at most twice its file, read back and
// all.
#include <malloc.h>

#include <filesystem>
#include <fstream>

#include "pipeline/formats/table/tabulate.h"
#include "tests/support/catch.h"
#include "tests/support/child_process.h"
#include "tests/support/process_memory.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test_material.h"

#if defined(__SANITIZE_ADDRESS__)
constexpr bool kCountsMemory = false;  // freed memory stays in quarantine
#elif defined(__has_feature)
constexpr bool kCountsMemory = !__has_feature(address_sanitizer);
#else
constexpr bool kCountsMemory = true;
#endif

using namespace miebrdf;

namespace {

/// A format at a fineness that makes some ten megabytes.
struct Large {
    const char* format;
    int resolution;
};

ExportOptions options_of(const Large& large) {
    ExportOptions options;
    options.resolution = large.resolution;
    options.largest_error = 1e9;
    if (large.format == std::string("exr")) {
        // Values that no compression shrinks much are what its memory is compared with.
        options.directions.azimuth_deg = equally_spaced(0.0, 180.0, 129);
    }
    return options;
}

}  // namespace

TEST_CASE("an export takes at most twice its file in memory", "[formats][memory]") {
    if (!kCountsMemory) return;
    const Large large =
        GENERATE(Large{"csv", 32}, Large{"json", 48}, Large{"npz", 64}, Large{"exr", 64},
                 Large{"pbrt", 330}, Large{"rgl", 128}, Large{"merl", 0}, Large{"ssdd", 81},
                 Large{"astm", 50}, Large{"radiance", 7});
    const support::TestMaterial material(support::seven_wavelengths(), 0.4);
    const support::TemporaryFolder folder;
    const auto path = folder / "large";
    const ExportOptions options = options_of(large);
    malloc_trim(0);  // else the child begins with free memory that no count shows
    const pid_t child = support::in_child(
        [&] {
            const double before = support::resident_bytes();
            export_brdf(material, find_format(large.format), path, options, {.threads = 1});
            std::ofstream(folder / "memory") << support::peak_bytes() - before;
        },
        [](const std::exception&) { return 1; });
    REQUIRE(support::exit_code(child) == 0);
    double memory = 0.0, bytes = 0.0;
    std::ifstream(folder / "memory") >> memory;
    for (const auto& entry : std::filesystem::directory_iterator(folder.path())) {
        if (entry.path().filename() != "memory") bytes = std::max(bytes, double(entry.file_size()));
    }
    CAPTURE(large.format, bytes / 1e6, memory / 1e6, memory / bytes);
    CHECK(bytes >= 12e6);  // three times as much would not pass
    // Beside the file's own: code that is paged in, and the C library's reserves.
    CHECK(memory <= 2.0 * bytes + 8e6);
}
