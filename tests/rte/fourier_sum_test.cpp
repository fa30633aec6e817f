#include "rte/stack/fourier_sum.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "rte/math/tolerance_budget.h"
#include "rte/stack/layered_reflection.h"
#include "tests/support/catch.h"

using namespace miebrdf;

namespace {

/// Orders until the tail ends, of sizes size(0), size(1), ...
template <typename Size>
int orders_of(double tolerance, Size size, bool may_dip = false) {
    rte::FourierTail tail(tolerance, may_dip);
    for (int m = 0; m < 200; ++m) {
        if (tail.ends_with(size(m))) return m + 1;
    }
    return 200;
}

const rte::RequestedDirections pair{Eigen::VectorXd::Constant(1, 0.5), {0}, {0}};

Eigen::MatrixXd value(double R) { return Eigen::MatrixXd::Constant(1, 1, R); }

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

TEST_CASE("dips of a series do not end it where it may dip", "[rte][orders]") {
    // A lobe that leaves 20 degrees off the plane of incidence: zero near order 4.5, 13.5, ...
    const auto lobe = [](int m) {
        return std::exp(-0.01 * m * m) * std::abs(std::cos(20.0 * std::numbers::pi / 180.0 * m));
    };
    const double tolerance = GENERATE(1e-2, 1e-3, 1e-4);
    const int orders = orders_of(tolerance, lobe, true);
    double rest = 0.0;
    for (int m = orders; m < 200; ++m) rest += 2.0 * lobe(m);
    CAPTURE(tolerance, orders, rest);
    CHECK(rest <= tolerance);
    CHECK(orders <= 50);
    CHECK(orders_of(
              tolerance, [](int m) { return m == 0 ? 1.0 : 0.0; }, true) <= 8);
}

TEST_CASE("orders that fall slowly end with two below the tolerance, none with nothing",
          "[rte][orders]") {
    // Slower than 0.7: 2 (0.7 / 0.3) 0.9^(m - 1) <= 1e-3 from m = 82 on.
    CHECK(orders_of(1e-3, [](int m) { return std::pow(0.9, m); }) == 83);
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

TEST_CASE("orders are taken over after two that agree, and never from nothing", "[rte][orders]") {
    const rte::FourierOrders coarse{value(1.0), value(0.5), value(0.2), value(0.1)};
    rte::CoarserFourierOrders orders(coarse, 1e-2);
    orders.compare(0, value(1.005), pair);
    CHECK(orders.settled(1) == nullptr);
    orders.compare(1, value(0.52), pair);  // 0.02 apart
    orders.compare(2, value(0.2), pair);
    CHECK(orders.settled(3) == nullptr);
    orders.compare(3, value(0.1001), pair);
    REQUIRE(orders.settled(3) == &coarse[3]);
    // Of the two that agree the worse, and others differ by up to ten times as much.
    CHECK(orders.difference() == Approx(10 * 1e-4 / 1.005).epsilon(1e-10));
    CHECK(orders.settled(4) == nullptr);  // the coarser solution ended before

    const rte::FourierOrders none;
    rte::CoarserFourierOrders alone(none, 1e-2);
    alone.compare(0, value(1.0), pair);
    alone.compare(1, value(1.0), pair);
    CHECK(alone.settled(2) == nullptr);
}

TEST_CASE("an order 0 that agrees ten times better settles all orders, and is doubted ten times",
          "[rte][orders]") {
    const rte::FourierOrders coarse{value(1.0), value(0.5)};
    rte::CoarserFourierOrders close(coarse, 1e-2);
    close.compare(0, value(1.0009), pair);
    CHECK(close.settled(1) == &coarse[1]);
    CHECK(close.difference() == Approx(1e-2 * 0.9 / 1.0009).epsilon(1e-9));
    rte::CoarserFourierOrders further(coarse, 1e-2);
    further.compare(0, value(1.0011), pair);
    CHECK(further.settled(1) == nullptr);
}

TEST_CASE("a single direction gets the value it has among many", "[rte][orders]") {
    const rte::Stack stack{.base = rte::henyey_greenstein_optics(0.95, 0.7),
                           .coats = {{rte::henyey_greenstein_optics(0.8, 0.5), 0.5}}};
    const rte::Directions many{
        {0.05, 0.2, 0.35, 0.5, 0.8, 1.0}, {0.07, 0.3, 0.6, 0.9, 1.0}, {0, 60, 90}};
    const double tolerance = GENERATE(1e-3, 1e-6);
    const rte::SolverOptions options{.tolerance = tolerance, .streams = 24};
    const auto table = rte::reflect(stack, many, options);
    std::size_t k = 0;
    for (const double mu_in : many.mu_in) {
        for (const double mu_out : many.mu_out) {
            for (const double azimuth : many.azimuth_deg) {
                const auto one = rte::reflect(stack, {{mu_in}, {mu_out}, {azimuth}}, options);
                CAPTURE(mu_in, mu_out, azimuth, tolerance);
                REQUIRE(one.reflection.size() == 1);
                REQUIRE(one.plane_albedo.size() == 1);
                // Each stops its orders, and takes them over, where its own directions allow it.
                CHECK(std::abs(one.reflection[0] / table.reflection[k++] - 1.0) <= tolerance);
            }
        }
    }
}

TEST_CASE("what is taken over from fewer nodes stays within the tolerance and in the estimate",
          "[rte][orders]") {
    const rte::Stack stack{.base = rte::henyey_greenstein_optics(0.98, 0.7),
                           .coats = {{rte::henyey_greenstein_optics(0.9, 0.5), 0.2}}};
    const rte::Directions directions{{0.15, 0.6, 1.0}, {0.1, 0.5, 0.9}, {0, 70, 180}};
    // No order of 24 nodes agrees with 16 to 1e-16: every one is solved.
    const auto truth = rte::reflect(stack, directions, {.tolerance = 1e-14, .streams = 96});
    const double tolerance = GENERATE(1e-2, 1e-3, 1e-4, 1e-5);
    const auto result = rte::reflect(stack, directions, {.tolerance = tolerance, .streams = 24});
    double worst = 0.0;
    for (std::size_t in = 0; in < 3; ++in) {
        double scale = 0.0;
        double error = 0.0;
        for (std::size_t k = 9 * in; k < 9 * in + 9; ++k) {
            scale = std::max(scale, truth.reflection[k]);
            error = std::max(error, std::abs(result.reflection[k] - truth.reflection[k]));
        }
        worst = std::max(worst, error / scale);
    }
    CAPTURE(tolerance, worst, result.report.error_estimate);
    CHECK(result.report.converged);
    CHECK(worst <= tolerance);
    CHECK(worst <= 3.0 * result.report.error_estimate);
}

TEST_CASE("across a forward peak the sum ends by the values there, not by order 0",
          "[rte][orders]") {
    // At 90 degrees the values are a tenth of order 0: ended by that, the sum was 3 % to 30 % off.
    const rte::Stack stack{.base = rte::henyey_greenstein_optics(0.9, 0.95)};
    const double mu = GENERATE(0.02, 0.05);
    const double tolerance = GENERATE(1e-1, 1e-2, 1e-3);
    const rte::Directions across{{mu}, {mu}, {90}};
    const auto truth = rte::reflect(stack, across, {.tolerance = 1e-8, .streams = 96});
    // Two numbers of nodes; at the same number only the end of the sum tells them apart, and the
    // moments that are dropped (1.2e-3 at a tolerance of 1e-2, in no estimate).
    const int streams = GENERATE(0, 96);
    const auto result = rte::reflect(stack, across, {.tolerance = tolerance, .streams = streams});
    const double error = std::abs(result.reflection[0] / truth.reflection[0] - 1);
    CAPTURE(mu, tolerance, streams, result.report.error_estimate, error);
    CHECK(result.report.converged);
    CHECK(error <= tolerance);
    if (streams == 96)
        CHECK(error <= std::max(result.report.error_estimate, kFourierTailShare * tolerance));
}
