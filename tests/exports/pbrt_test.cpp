#include "pipeline/exports/pbrt_writer.h"

#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>
#include <sstream>

#include "pipeline/error.h"
#include "pipeline/exports/deviation.h"
#include "tests/support/catch.h"
#include "tests/support/sampling.h"
#include "tests/support/test_material.h"

using namespace miebrdf;
using namespace miebrdf::exports;

namespace {

struct Written {
    support::TestMaterial material{support::seven_wavelengths(), 0.4};
    RgbSource rgb{material, nearest_wavelengths(support::seven_wavelengths())};
    std::string content;

    explicit Written(const PbrtOptions& options = {}) {
        std::ostringstream out;
        write_pbrt(rgb, options, out);
        content = out.str();
    }

    std::uint32_t field(std::size_t offset) const {
        std::uint32_t value = 0;
        std::memcpy(&value, content.data() + offset, 4);
        return value;
    }
    float real(std::size_t offset) const {
        float value = 0;
        std::memcpy(&value, content.data() + offset, 4);
        return value;
    }
};

}  // namespace

TEST_CASE("pbrt: header, nodes and sizes are where pbrt-v3 and layerlab look for them",
          "[exports][pbrt]") {
    const Written file(PbrtOptions{.intervals = 16});
    const std::uint32_t n = file.field(12);
    CHECK(file.content.substr(0, 8) == std::string("SCATFUN\x01"));
    CHECK(file.field(8) == 1);
    CHECK(n == 34);
    CHECK(file.field(24) == 3);
    CHECK(file.field(28) == 1);
    CHECK(file.field(36) == 0);
    CHECK(file.field(40) == 0);
    CHECK(file.real(44) == 1.0f);
    // layerlab checks the exact size.
    CHECK(file.content.size() ==
          64 + 4 * n + 12 * n * n + 4 * std::size_t{file.field(16)} + file.field(32));
    CHECK(file.real(64) == -1.0f);
    CHECK(file.real(64 + 4 * (n / 2 - 1)) == 0.0f);
    CHECK(file.real(64 + 4 * (n / 2)) == 0.0f);
    CHECK(file.real(64 + 4 * (n - 1)) == 1.0f);
    // The mean of the normal pair, stored with the light's cosine: row mu = 1, column mu = -1.
    const std::size_t series = 64 + 4 * n + 4 * n * n + 8 * std::size_t{(n - 1) * n};
    const std::size_t first = 64 + 4 * n + 12 * n * n + 4 * std::size_t{file.field(series)};
    const std::uint32_t length = file.field(series + 4);
    double rgb[3];
    const Direction normal{1.0, 1.0, 0.0};
    file.rgb.evaluate({&normal, 1}, rgb);
    CHECK(file.real(first + 4 * length) == Approx(rgb[0]).epsilon(1e-6));
    CHECK(file.real(first + 8 * length) == Approx(rgb[2]).epsilon(1e-6));
    const auto metadata =
        nlohmann::json::parse(file.content.substr(file.content.size() - file.field(32)));
    CHECK(metadata["azimuth_zero"] == "mirror side");
    CHECK(metadata["sources"][0] == "a closed form");
}

TEST_CASE("pbrt: rows at the horizon hold the limit, not nothing", "[exports][pbrt]") {
    // layerlab leaves them empty and loses up to 7 % of the albedo at mu_out = 0.1.
    const Written file(PbrtOptions{.intervals = 8});
    const std::uint32_t n = file.field(12);
    for (const std::uint32_t row : {n / 2 - 1, n / 2}) {
        for (std::uint32_t column = 0; column + 1 < n / 2; ++column) {
            CHECK(file.field(64 + 4 * n + 4 * n * n + 8 * std::size_t{row * n + column} + 4) > 0);
        }
    }
}

TEST_CASE("pbrt: read as pbrt-v3 reads it, errors stay within the table of docs/formats/pbrt.md",
          "[exports][pbrt]") {
    // Twice what a correct writer reached with these nodes, for single-precision figures.
    const auto [intervals, bounds] = GENERATE(std::pair{16, std::array{1.0e-3, 2.2e-3, 2.2e-2}},
                                              std::pair{48, std::array{1.04e-4, 1.7e-4, 1.8e-3}});
    const Written file(PbrtOptions{.intervals = intervals});
    const auto read = read_brdf_file(file.content, "test");
    const Deviation deviation = measure_deviation(*read, file.rgb, random_directions(6000, 1));
    CAPTURE(intervals, deviation.rms, file.content.size());
    for (std::size_t band = 0; band < 3; ++band) CHECK(deviation.rms[band] <= bounds[band]);
    CHECK(deviation.missing == 0);
}

TEST_CASE("pbrt: sampling by the stored integrals carries the whole albedo", "[exports][pbrt]") {
    const Written file;
    const auto read = read_brdf_file(file.content, "test");
    for (const double mu : {0.1, 0.5, 0.95}) {
        const auto sampled = support::sampled_albedo(*read, mu, 10000);
        const auto expected = support::integrated_albedo(file.rgb, mu);
        CAPTURE(mu, sampled, expected);
        for (std::size_t c = 0; c < 3; ++c) CHECK(std::abs(sampled[c] / expected[c] - 1) <= 2e-3);
    }
}

TEST_CASE("pbrt: samples pass a chi-square test against the density", "[exports][pbrt]") {
    const Written file(PbrtOptions{.intervals = 24});
    const auto read = read_brdf_file(file.content, "test");
    for (const double mu : {0.15, 0.8}) {
        const double probability = support::chi_square_probability(*read, mu, 50000);
        CAPTURE(mu, probability);
        CHECK(probability >= 1e-3);
    }
}

TEST_CASE("pbrt: options out of range are refused", "[exports][pbrt][errors]") {
    CHECK_THROWS_WITH(Written(PbrtOptions{.intervals = 3}),
                      Catch::Contains("3") && Catch::Contains("4 to 500"));
}
