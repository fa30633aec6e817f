#include "pipeline/exports/azimuth_series.h"

#include <cmath>

#include "pipeline/error.h"
#include "tests/support/catch.h"
#include "tests/support/test_material.h"

using namespace miebrdf;
using namespace miebrdf::exports;

TEST_CASE("azimuth series of g = 0.4 sums back to the BRDF at azimuths it was not sampled at",
          "[exports][azimuth_series]") {
    const support::TestMaterial material({450, 650}, 0.4);
    const std::vector<CosinePair> pairs = {{0.3, 0.7}, {1.0, 0.2}, {0.05, 0.04}};
    const AzimuthSeries series = azimuth_series(material, pairs, 1e-9, 512, {});
    CHECK(series.tail <= 1e-9);
    for (std::size_t p = 0; p < pairs.size(); ++p) {
        for (std::size_t c = 0; c < 2; ++c) {
            const double azimuth_deg = 73.4;
            double sum = 0.0;
            for (std::size_t k = 0; k < series.orders(p); ++k) {
                sum += series.of(p, c)[k] *
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
          "[exports][azimuth_series]") {
    const support::SharpMaterial material({550}, 0.02);
    const std::vector<CosinePair> pairs = {{0.5, 0.5}, {0.5, 0.9}};
    const AzimuthSeries series = azimuth_series(material, pairs, 1e-6, 2048, {});
    CHECK(series.tail <= 1e-6);
    CHECK(series.orders(0) >= 257);
    CHECK(series.orders(1) == 65);
}

TEST_CASE("azimuth series stops at the orders allowed and says what is missing",
          "[exports][azimuth_series]") {
    const support::SharpMaterial material({550}, 0.02);
    const std::vector<CosinePair> pairs = {{0.5, 0.5}};
    const AzimuthSeries series = azimuth_series(material, pairs, 1e-6, 32, {});
    CHECK(series.orders(0) == 33);
    // A lobe of 0.02 rad half-width in azimuth needs some hundred orders.
    CHECK(series.tail >= 0.1);
    CHECK_THROWS_WITH(azimuth_series(material, pairs, 1e-6, 5, {}),
                      Catch::Contains("5") && Catch::Contains("16 to 4096"));
}
