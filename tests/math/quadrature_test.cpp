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
        // n sums of rounded weights; slopes carry a few units in the last place.
        CHECK(std::abs(sum * (degree + 1) - 1) <= 40 * n * std::numeric_limits<double>::epsilon());
    }
}

TEST_CASE("Gauss-Legendre with thousands of nodes integrates fast waves", "[math][quadrature]") {
    const int n = GENERATE(4513, 8192);
    const auto rule = math::gauss_legendre(n);
    for (const double waves : {1.0, 100.0, 4000.0}) {
        double sum = 0;
        for (int i = 0; i < n; ++i) sum += rule.weights[i] * std::cos(waves * rule.nodes[i]);
        // The phase of the wave is rounded at each of n nodes, and so are nodes and weights: those
        // come from recurrences of n steps, and the sum has n terms.
        CHECK(std::abs(sum - 2 * std::sin(waves) / waves) <=
              (40 * waves + std::sqrt(n)) * std::numeric_limits<double>::epsilon());
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

TEST_CASE("a Gauss rule for weighted points gives polynomials the sum over all of them",
          "[math][quadrature]") {
    // 300 points with the weights of a crooked density, which no rule by name belongs to.
    math::Quadrature points;
    for (int i = 0; i < 300; ++i) {
        const double x = -1 + 2 * (i + 0.5) / 300;
        points.nodes.push_back(x);
        points.weights.push_back(0.01 * std::exp(-3 * x) * (1.2 + std::sin(9 * x)));
    }
    const int count = GENERATE(2, 3, 8, 16, 32);
    const auto kind = GENERATE(math::GaussRule::gauss, math::GaussRule::radau);
    const auto rule = math::gauss_rule(points, count, kind);
    const bool is_radau = kind == math::GaussRule::radau;
    REQUIRE(rule.nodes.size() == static_cast<std::size_t>(count));
    for (int i = 0; i < count; ++i) {
        CHECK(rule.weights[i] > 0);
        if (i > 0) CHECK(rule.nodes[i] > rule.nodes[i - 1]);
    }
    if (is_radau) CHECK(std::abs(rule.nodes.front() - points.nodes.front()) <= 1e-12);
    const auto sum_of = [](const math::Quadrature& over, int degree) {
        double sum = 0;
        for (std::size_t i = 0; i < over.nodes.size(); ++i)
            sum += over.weights[i] * std::pow(over.nodes[i], degree);
        return sum;
    };
    const double whole = sum_of(points, 0);
    const int exact = 2 * count - (is_radau ? 2 : 1);
    for (int degree = 0; degree <= exact; ++degree) {
        CAPTURE(count, is_radau, degree);
        // Rounding of some hundred sums, and of the eigenvalues.
        CHECK(std::abs(sum_of(rule, degree) - sum_of(points, degree)) <= 1e-13 * whole);
    }
    // And no further: the next one is missed, while few nodes leave more than rounding.
    if (count <= 8)
        CHECK(std::abs(sum_of(rule, exact + 1) - sum_of(points, exact + 1)) > 1e-9 * whole);
    CHECK_THROWS_WITH(math::gauss_rule(points, 65), Catch::Contains("65"));
}
