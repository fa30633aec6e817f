#include "pipeline/formats/pbrt/azimuth_series.h"

#include <cmath>

#include <miebrdf/error.h>
#include "tests/support/catch.h"
#include "tests/support/test_material.h"

using namespace miebrdf;
using namespace miebrdf::exports;

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
          "[exports][azimuth_series]") {
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
          "[exports][azimuth_series]") {
    const support::SharpMaterial material({550}, 0.02);
    const std::vector<CosinePair> pairs = {{0.5, 0.5}, {0.5, 0.9}};
    const auto series = all_series(material, pairs, 1e-6, 2048);
    CHECK(std::max(series[0].tail, series[1].tail) <= 1e-6);
    CHECK(series[0].orders() >= 257);
    CHECK(series[1].orders() == 65);
}

TEST_CASE("azimuth series stops at the orders allowed and says what is missing",
          "[exports][azimuth_series]") {
    const support::SharpMaterial material({550}, 0.02);
    const std::vector<CosinePair> pairs = {{0.5, 0.5}};
    const auto series = all_series(material, pairs, 1e-6, 32);
    CHECK(series[0].orders() == 33);
    // A lobe of 0.02 rad half-width in azimuth needs some hundred orders.
    CHECK(series[0].tail >= 0.1);
    CHECK_THROWS_WITH(all_series(material, pairs, 1e-6, 5),
                      Catch::Contains("5") && Catch::Contains("16 to 4096"));
}
