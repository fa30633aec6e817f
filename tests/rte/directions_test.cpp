#include "rte/grid/directions.h"

#include <cmath>

#include <miebrdf/error.h>
#include "tests/support/catch.h"

using namespace miebrdf;

TEST_CASE("each grid integrates powers of mu as its definition promises", "[rte][grid]") {
    const int n = GENERATE(2, 5, 16, 64);
    // Degree up to which the rule is exact: 2n - 1 for Gauss, (2n - 3)/3 with mu = t^2 (2 - t).
    for (int power = 0; power <= 2 * n - 1; ++power) {
        const auto integral = [&](const rte::ZenithGrid& grid) {
            return grid.weights.dot(grid.mu.array().pow(power).matrix()) * (power + 1);
        };
        CAPTURE(n, power);
        CHECK(std::abs(integral(rte::make_gauss_grid(n)) - 1.0) <= 1e-13 * n);
        if (3 * power <= 2 * n - 3) {
            CHECK(std::abs(integral(rte::make_mapped_gauss_grid(n)) - 1.0) <= 1e-13 * n);
        }
    }
}

TEST_CASE("the paper's grid is eq. (4): cosines of Gauss nodes, clustered at the zenith",
          "[rte][grid]") {
    const auto grid = rte::make_paper_grid(16);
    CHECK(grid.mu[15] > rte::make_gauss_grid(16).mu[15]);
    CHECK(std::abs(grid.weights.sum() - 1.0) <= 1e-14);
    CHECK(std::abs(grid.weights.dot(grid.mu) - 0.5) <= 1e-12);
    for (int i = 1; i < 16; ++i) CHECK(grid.mu[i] > grid.mu[i - 1]);
}

TEST_CASE("grids refuse a number of nodes out of range with the value in the message",
          "[rte][grid][errors]") {
    const int n = GENERATE(1, 0, -3, 257);
    CHECK_THROWS_WITH(rte::make_zenith_grid(rte::GridKind::gauss, n),
                      Catch::Contains(std::to_string(n)) && Catch::Contains("2 to 256"));
    CHECK_THROWS_AS(rte::make_zenith_grid(rte::GridKind::automatic, 8), UsageError);
}
