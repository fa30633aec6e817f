#include "rte/stack/fourier_sum.h"

#include <cmath>

#include "rte/stack/layered_reflection.h"
#include "tests/support/catch.h"

using namespace miebrdf;

namespace {

const rte::RequestedDirections pair{Eigen::VectorXd::Constant(1, 0.5), {0}, {0}};

Eigen::MatrixXd value(double R) { return Eigen::MatrixXd::Constant(1, 1, R); }

}  // namespace

TEST_CASE("orders are taken over after two that agree, and never from nothing", "[rte][orders]") {
    const rte::OrderList coarse{value(1.0), value(0.5), value(0.2), value(0.1)};
    rte::CoarserOrders orders(coarse, 1e-2);
    orders.compare(0, value(1.005), pair);
    CHECK(orders.settled(1) == nullptr);
    orders.compare(1, value(0.52), pair);  // 0.02 apart
    orders.compare(2, value(0.2), pair);
    CHECK(orders.settled(3) == nullptr);
    orders.compare(3, value(0.1001), pair);
    REQUIRE(orders.settled(3) == &coarse[3]);
    CHECK(orders.difference() == Approx(1e-4 / 1.005).epsilon(1e-10));
    CHECK(orders.settled(4) == nullptr);  // the coarser solution ended before

    const rte::OrderList none;
    rte::CoarserOrders alone(none, 1e-2);
    alone.compare(0, value(1.0), pair);
    alone.compare(1, value(1.0), pair);
    CHECK(alone.settled(2) == nullptr);
}

TEST_CASE("an order 0 that agrees ten times better settles all orders, and is doubted ten times",
          "[rte][orders]") {
    const rte::OrderList coarse{value(1.0), value(0.5)};
    rte::CoarserOrders close(coarse, 1e-2);
    close.compare(0, value(1.0009), pair);
    CHECK(close.settled(1) == &coarse[1]);
    CHECK(close.difference() == Approx(1e-2 * 0.9 / 1.0009).epsilon(1e-9));
    rte::CoarserOrders further(coarse, 1e-2);
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
