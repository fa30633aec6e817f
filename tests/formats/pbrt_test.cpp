// The Fourier file and the series that it is made of.
#include <cmath>
#include <nlohmann/json.hpp>

#include <miebrdf/error.h>
#include "pipeline/formats/pbrt/azimuth_series.h"
#include "tests/support/catch.h"
#include "tests/support/outside/bytes.h"
#include "tests/support/test_material.h"
#include "tests/support/written_file.h"

using namespace miebrdf;
using support::number_at;

namespace {

std::vector<AzimuthSeries> all_series(const BrdfSource& source,
                                      const std::vector<CosinePair>& pairs, double tail_tolerance,
                                      int most_orders) {
    std::vector<AzimuthSeries> list(pairs.size());
    azimuth_series(source, pairs, tail_tolerance, most_orders, {},
                   [&](std::size_t p, const AzimuthSeries& series) { list[p] = series; });
    return list;
}

}  // namespace

TEST_CASE("azimuth series of g = 0.4 sums back to the BRDF at azimuths it was not sampled at",
          "[formats][azimuth_series]") {
    const support::TestMaterial material({450, 650}, 0.4);
    const std::vector<CosinePair> pairs = {{0.3, 0.7}, {1.0, 0.2}, {0.05, 0.04}};
    const auto series = all_series(material, pairs, 1e-9, 512);
    for (std::size_t p = 0; p < pairs.size(); ++p) {
        CHECK(series[p].tail <= 1e-9);
        for (std::size_t c = 0; c < 2; ++c) {
            const double azimuth_deg = 73.4;
            double sum = 0.0;
            for (std::size_t k = 0; k < series[p].orders(); ++k) {
                sum += series[p].of(c)[k] *
                       std::cos(static_cast<double>(k) * azimuth_deg * M_PI / 180);
            }
            double expected[2];
            const Direction direction{pairs[p].mu_in, pairs[p].mu_out, azimuth_deg};
            material.evaluate({&direction, 1}, expected);
            // Aliasing is of the size of the terms left out: a few times the tail.
            CHECK(std::abs(sum / expected[c] - 1) <= 1e-7);
        }
    }
}

TEST_CASE("azimuth series: only pairs that see a narrow lobe get many orders",
          "[formats][azimuth_series]") {
    const support::SharpMaterial material({550}, 0.02);
    const std::vector<CosinePair> pairs = {{0.5, 0.5}, {0.5, 0.9}};
    const auto series = all_series(material, pairs, 1e-6, 2048);
    CHECK(std::max(series[0].tail, series[1].tail) <= 1e-6);
    CHECK(series[0].orders() >= 257);
    CHECK(series[1].orders() == 65);
}

TEST_CASE("azimuth series stops at the orders allowed and says what is missing",
          "[formats][azimuth_series]") {
    const support::SharpMaterial material({550}, 0.02);
    const std::vector<CosinePair> pairs = {{0.5, 0.5}};
    const auto series = all_series(material, pairs, 1e-6, 32);
    CHECK(series[0].orders() == 33);
    // A lobe of 0.02 rad half-width in azimuth needs some hundred orders.
    CHECK(series[0].tail >= 0.1);
    CHECK_THROWS_WITH(all_series(material, pairs, 1e-6, 5),
                      Catch::Contains("5") && Catch::Contains("16 to 4096"));
}

TEST_CASE("azimuth series of a peak narrower than its orders keep its mean and do not ring",
          "[formats][azimuth_series]") {
    // 32 samples of a lobe of 0.02 rad would count it several times over, and ring around it.
    const support::SharpMaterial narrow({550}, 0.02);
    const support::TestMaterial without({550}, 0.4);
    const std::vector<CosinePair> pairs = {{0.5, 0.5}};
    const auto tapered = all_series(narrow, pairs, 1e-6, 32);
    const auto whole = all_series(narrow, pairs, 1e-6, 2048);
    CHECK(tapered[0].of(0)[0] == Approx(whole[0].of(0)[0]).epsilon(1e-3));
    for (double azimuth = 30.0; azimuth <= 180.0; azimuth += 1.0) {
        double sum = 0.0;
        for (std::size_t k = 0; k < tapered[0].orders(); ++k)
            sum += tapered[0].of(0)[k] * std::cos(static_cast<double>(k) * azimuth * M_PI / 180);
        double base = 0.0;
        const Direction direction{0.5, 0.5, azimuth};
        without.evaluate({&direction, 1}, {&base, 1});
        CAPTURE(azimuth, base);
        CHECK(sum >= 0.9 * base);  // the damping widens what is smooth, too, by a little
    }
}

namespace {

std::string written(int intervals) {
    return support::written_file("pbrt", support::material(), {.resolution = intervals});
}

std::uint32_t field(const std::string& file, std::size_t offset) {
    return number_at<std::uint32_t>(file, offset);
}

}  // namespace

TEST_CASE("pbrt: header, nodes and sizes are where pbrt-v3 and layerlab look for them",
          "[formats][pbrt]") {
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

TEST_CASE("pbrt: rows at the horizon hold the limit, not nothing", "[formats][pbrt]") {
    // layerlab leaves them empty and loses up to 7 % of the albedo at mu_out = 0.1.
    const std::string file = written(8);
    const std::uint32_t n = field(file, 12);
    for (const std::uint32_t row : {n / 2 - 1, n / 2}) {
        for (std::uint32_t column = 0; column + 1 < n / 2; ++column) {
            CHECK(field(file, 64 + 4 * n + 4 * n * n + 8 * std::size_t{row * n + column} + 4) > 0);
        }
    }
}

TEST_CASE("pbrt: options out of range are refused", "[formats][pbrt][errors]") {
    CHECK_THROWS_WITH(written(3), Catch::Contains("3") && Catch::Contains("4 to 500"));
}
