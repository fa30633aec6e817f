#include "rte/stack/fourier_sum.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "rte/stack/layered_reflection.h"
#include "tests/support/catch.h"

using namespace miebrdf;

namespace {

/// Orders until the tail ends, of sizes size(0), size(1), ...
template <typename Size>
int orders_of(double tolerance, Size size) {
    rte::OrderTail tail(tolerance);
    for (int m = 0; m < 200; ++m) {
        if (tail.ends_with(size(m))) return m + 1;
    }
    return 200;
}

}  // namespace

TEST_CASE("a geometric tail ends where twice its rest is below the tolerance", "[rte][orders]") {
    const double r = GENERATE(0.1, 0.4, 0.69);
    const double tolerance = GENERATE(1e-3, 1e-8);
    const int orders = orders_of(tolerance, [r](int m) { return std::pow(r, m); });
    // Exact: what is left of 1 + 2 sum r^m after so many orders. The fourth order is the first at
    // which two ratios are known.
    CAPTURE(r, tolerance, orders);
    CHECK(2 * std::pow(r, orders) / (1 - r) <= tolerance);
    if (orders > 4) CHECK(2 * std::pow(r, orders - 1) / (1 - r) > tolerance);
}

TEST_CASE("one small order by accident does not end the sum", "[rte][orders]") {
    const auto accident = [](int m) { return m == 5 ? 1e-12 : std::pow(0.6, m); };
    CHECK(orders_of(1e-6, accident) > 25);  // 0.6^25 = 3e-6
    // Every second order zero: the others decide.
    const auto even_only = [](int m) { return m % 2 == 1 ? 0.0 : std::pow(0.6, m); };
    CHECK(orders_of(1e-6, even_only) > 25);
}

TEST_CASE("orders that fall slowly end with two below the tolerance, none with nothing",
          "[rte][orders]") {
    // 2.5 0.9^(m - 1) <= 1e-3 from m = 76 on.
    CHECK(orders_of(1e-3, [](int m) { return std::pow(0.9, m); }) == 77);
    CHECK(orders_of(1e-3, [](int) { return 0.0; }) == 2);
}

TEST_CASE("across the plane of incidence odd orders are left out and change nothing",
          "[rte][orders]") {
    const rte::Stack stack{.base = rte::henyey_greenstein_optics(0.95, 0.6),
                           .coats = {{rte::henyey_greenstein_optics(0.8, 0.4), 0.3}}};
    const rte::SolverOptions exact{.tolerance = 1e-14, .streams = 16};
    const rte::Directions across{{0.3, 0.8}, {0.2, 0.9}, {90, 270}};
    rte::Directions with_another = across;
    with_another.azimuth_deg.push_back(10);
    const auto even = rte::reflect(stack, across, exact).reflection;
    const auto all = rte::reflect(stack, with_another, exact).reflection;
    for (std::size_t pair = 0; pair < 4; ++pair) {
        for (std::size_t a = 0; a < 2; ++a) {
            // cos(m 90 degrees) is 1e-16 m in the one, 0 in the other: up to 32 orders.
            CHECK(std::abs(even[2 * pair + a] / all[3 * pair + a] - 1) <= 1e-13);
        }
    }
}
