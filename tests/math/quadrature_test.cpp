#include "rte/math/quadrature.h"

#include <cmath>
#include <limits>

#include "tests/support/catch.h"

using namespace miebrdf;

TEST_CASE("Gauss-Legendre integrates every monomial up to degree 2n - 1 exactly",
          "[math][quadrature]") {
    const int n = GENERATE(1, 2, 3, 7, 16, 31, 64, 129, 256);
    const auto rule = math::gauss_legendre(n, 0.0, 1.0);
    REQUIRE(rule.nodes.size() == static_cast<std::size_t>(n));
    for (int degree = 0; degree <= 2 * n - 1; ++degree) {
        double sum = 0;
        for (int i = 0; i < n; ++i) sum += rule.weights[i] * std::pow(rule.nodes[i], degree);
        CAPTURE(n, degree);
        // n sums of rounded weights; Boost's zeros and slopes carry a few units in the last place.
        CHECK(std::abs(sum * (degree + 1) - 1) <= 40 * n * std::numeric_limits<double>::epsilon());
    }
}

TEST_CASE("Gauss-Legendre with thousands of nodes integrates fast waves", "[math][quadrature]") {
    const int n = GENERATE(4513, 8192);
    const auto rule = math::gauss_legendre(n);
    for (const double waves : {1.0, 100.0, 4000.0}) {
        double sum = 0;
        for (int i = 0; i < n; ++i) sum += rule.weights[i] * std::cos(waves * rule.nodes[i]);
        // The phase of the wave is rounded at each of n nodes, and so are nodes and weights.
        CHECK(std::abs(sum - 2 * std::sin(waves) / waves) <=
              40 * waves * std::numeric_limits<double>::epsilon());
    }
}

TEST_CASE("quadrature nodes ascend inside the interval and weights are positive",
          "[math][quadrature]") {
    const auto rule = math::gauss_legendre(100, -3.0, 5.0);
    for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
        CHECK(rule.weights[i] > 0);
        CHECK(rule.nodes[i] > (i == 0 ? -3.0 : rule.nodes[i - 1]));
        CHECK(rule.nodes[i] < 5.0);
    }
}

TEST_CASE("quadrature refuses nonsense with the value in the message",
          "[math][quadrature][errors]") {
    CHECK_THROWS_WITH(math::gauss_legendre(0), Catch::Contains("0") && Catch::Contains("8192"));
    CHECK_THROWS_WITH(math::gauss_legendre(4, 1.0, 1.0), Catch::Contains("(1, 1)"));
    CHECK_THROWS_WITH(math::gauss_legendre(4, 0.0, std::nan("")), Catch::Contains("nan"));
}
