#include <nlohmann/json.hpp>

#include "tests/support/catch.h"
#include "tests/support/outside/bytes.h"
#include "tests/support/test_material.h"
#include "tests/support/written_file.h"

using namespace miebrdf;
using namespace miebrdf::exports;

namespace {

using support::number_at;

std::string written(int intervals) {
    return support::written_file("pbrt", support::material(), {.resolution = intervals});
}

std::uint32_t field(const std::string& file, std::size_t offset) {
    return number_at<std::uint32_t>(file, offset);
}

}  // namespace

TEST_CASE("pbrt: header, nodes and sizes are where pbrt-v3 and layerlab look for them",
          "[exports][pbrt]") {
    const std::string file = written(16);
    const std::uint32_t n = field(file, 12);
    CHECK(file.substr(0, 8) == std::string("SCATFUN\x01"));
    CHECK(field(file, 8) == 1);
    CHECK(n == 34);
    CHECK(field(file, 24) == 3);
    CHECK(field(file, 28) == 1);
    CHECK(field(file, 36) == 0);
    CHECK(field(file, 40) == 0);
    CHECK(number_at<float>(file, 44) == 1.0f);
    // layerlab checks the exact size.
    CHECK(file.size() ==
          64 + 4 * n + 12 * n * n + 4 * std::size_t{field(file, 16)} + field(file, 32));
    CHECK(number_at<float>(file, 64) == -1.0f);
    CHECK(number_at<float>(file, 64 + 4 * (n / 2 - 1)) == 0.0f);
    CHECK(number_at<float>(file, 64 + 4 * (n / 2)) == 0.0f);
    CHECK(number_at<float>(file, 64 + 4 * (n - 1)) == 1.0f);
    // The mean of the normal pair, stored with the light's cosine: row mu = 1, column mu = -1.
    const std::size_t series = 64 + 4 * n + 4 * n * n + 8 * std::size_t{(n - 1) * n};
    const std::size_t first = 64 + 4 * n + 12 * n * n + 4 * std::size_t{field(file, series)};
    const std::uint32_t length = field(file, series + 4);
    double rgb[3];
    const Direction normal{1.0, 1.0, 0.0};
    support::ColouredMaterial().rgb.evaluate({&normal, 1}, rgb);
    CHECK(number_at<float>(file, first + 4 * length) == Approx(rgb[0]).epsilon(1e-6));
    CHECK(number_at<float>(file, first + 8 * length) == Approx(rgb[2]).epsilon(1e-6));
    const auto metadata = nlohmann::json::parse(file.substr(file.size() - field(file, 32)));
    CHECK(metadata["azimuth_zero"] == "mirror side");
    CHECK(metadata["sources"][0] == "a closed form");
}

TEST_CASE("pbrt: rows at the horizon hold the limit, not nothing", "[exports][pbrt]") {
    // layerlab leaves them empty and loses up to 7 % of the albedo at mu_out = 0.1.
    const std::string file = written(8);
    const std::uint32_t n = field(file, 12);
    for (const std::uint32_t row : {n / 2 - 1, n / 2}) {
        for (std::uint32_t column = 0; column + 1 < n / 2; ++column) {
            CHECK(field(file, 64 + 4 * n + 4 * n * n + 8 * std::size_t{row * n + column} + 4) > 0);
        }
    }
}

TEST_CASE("pbrt: options out of range are refused", "[exports][pbrt][errors]") {
    CHECK_THROWS_WITH(written(3), Catch::Contains("3") && Catch::Contains("4 to 500"));
}
