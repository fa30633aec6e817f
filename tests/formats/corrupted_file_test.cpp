// Files cut short, with bits turned over, or with counts that promise the moon: an error, never a
// crash, never more memory than the file can justify.
#include <cstring>
#include <filesystem>
#include <random>
#include <sstream>

#include "tests/support/catch.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test_material.h"
#include "tests/support/written_file.h"

using namespace miebrdf;

namespace {

/// Beside the reference tables in the sources.
constexpr char kCorpus[] = MIEBRDF_REFERENCE_DIR "/../fuzz/corpus";

std::string small_file(const std::string& format) {
    const support::TestMaterial material({450, 550, 650}, 0.4);
    ExportOptions options;
    options.resolution = format == "radiance" ? 2 : 4;
    if (format == "rgl") options.extra["incident_angles"] = 4;
    options.directions = {{0.5, 1.0}, {0.3, 1.0}, {0.0, 90.0, 180.0}};
    return support::written_file(format, material, options);
}

/// Reads and, if that succeeds, evaluates: both may throw InputError, nothing else may happen.
bool survives(const std::string& content) {
    try {
        const auto file = read_brdf_file(content, "test");
        std::vector<double> values(file->channels().size());
        for (const double mu : {0.01, 0.5, 1.0}) {
            file->evaluate({mu, 0.6, 40.0}, values);
            const auto size = static_cast<std::size_t>(file->components() * file->components());
            std::vector<double> matrices(values.size() * size);
            file->evaluate_mueller({mu, 0.6, 40.0}, matrices);
            file->sample(mu, 0.3, 0.6);
        }
    } catch (const InputError&) {
    }
    return true;
}

}  // namespace

TEST_CASE("every truncation of every format is refused or harmless", "[formats][corrupted]") {
    const std::string format = GENERATE("csv", "json", "npz", "exr", "pbrt", "pbsdf", "rgl", "ssdd",
                                        "astm", "radiance", "mtlx");
    const std::string content = small_file(format);
    CAPTURE(format, content.size());
    const std::size_t step = std::max<std::size_t>(1, content.size() / 400);
    for (std::size_t size = 0; size < content.size(); size += step)
        CHECK(survives(content.substr(0, size)));
    CHECK_THROWS_AS(read_brdf_file(content.substr(0, content.size() / 2), "test"), InputError);
}

TEST_CASE("bytes turned over at random are refused or harmless", "[formats][corrupted]") {
    const std::string format = GENERATE("csv", "json", "npz", "exr", "pbrt", "pbsdf", "rgl", "ssdd",
                                        "astm", "radiance", "mtlx");
    const std::string content = small_file(format);
    std::mt19937 engine(5);
    for (int round = 0; round < 300; ++round) {
        std::string damaged = content;
        for (int hits = 0; hits < 4; ++hits) {
            // Headers matter most: half of the hits go there.
            const std::size_t range =
                engine() % 2 == 0 ? std::min<std::size_t>(256, content.size()) : content.size();
            damaged[engine() % range] = static_cast<char>(engine());
        }
        CHECK(survives(damaged));
    }
}

TEST_CASE("counts that the file cannot hold are refused before memory is taken",
          "[formats][corrupted]") {
    std::string pbrt = small_file("pbrt");
    const std::uint32_t huge = 0xffffffff;
    std::memcpy(pbrt.data() + 16, &huge, 4);
    CHECK_THROWS_WITH(read_brdf_file(pbrt, "test"), Catch::Contains("4294967295"));
    std::string rgl = small_file("rgl");
    const std::uint64_t vast = std::uint64_t{1} << 60;
    std::memcpy(rgl.data() + 42, &vast, 8);
    CHECK_THROWS_WITH(read_brdf_file(rgl, "test"), Catch::Contains("larger than the file"));
    std::string merl(12, '\0');
    merl[0] = merl[4] = 90;
    merl[8] = static_cast<char>(180);
    CHECK_THROWS_WITH(read_brdf_file(merl, "test"), Catch::Contains("4374000"));
}

TEST_CASE("a Fourier file short of one byte, or with bytes to spare, is refused as in layerlab",
          "[formats][corrupted]") {
    const std::string content = small_file("pbrt");
    CHECK_NOTHROW(read_brdf_file(content, "test"));
    CHECK_THROWS_AS(read_brdf_file(content.substr(0, content.size() - 1), "test"), InputError);
    CHECK_THROWS_AS(read_brdf_file(content + '\0', "test"), InputError);
}

TEST_CASE("messages quote a hostile file without its control characters", "[formats][corrupted]") {
    std::string content = small_file("rgl");
    content.replace(20, 4, "\x1b[2J");  // in the name of the first field
    content[33] = '\x7f';               // an unknown type
    CHECK_THROWS_WITH(read_brdf_file(content, "test"),
                      Catch::Contains("?[2Jription") && !Catch::Contains("\x1b"));
}

TEST_CASE("what is no BRDF file is refused by name", "[formats][corrupted]") {
    CHECK_THROWS_WITH(read_brdf_file("hello", "letter.txt"),
                      Catch::Contains("letter.txt") && Catch::Contains("pbrt"));
    CHECK_THROWS_AS(open_brdf_file("/nowhere/at/all"), InputError);
    CHECK_THROWS_AS(read_brdf_file(std::string(100000, '['), "x"), InputError);
    CHECK_THROWS_AS(read_brdf_file("{\"a\":" + std::string(100000, '['), "x"), InputError);
}

TEST_CASE("files of the fuzzing corpus are read, or refused, as when they were found",
          "[formats][corrupted]") {
    // Beginnings for the fuzzers, one folder for each reader; what they find is added here.
    int files = 0;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(kCorpus)) {
        if (!entry.is_regular_file()) continue;
        CAPTURE(entry.path().string());
        CHECK(survives(support::read_file(entry.path())));
        ++files;
    }
    CHECK(files >= 10);
}
