#include "rte/stack/layered_reflection.h"

#include <algorithm>
#include <cmath>
#include <random>

#include "rte/grid/directions.h"
#include "rte/math/quadrature.h"
#include "tests/rte/reference_cases.h"
#include "tests/support/catch.h"

using namespace miebrdf;

TEST_CASE("two solutions that agree by accident at one azimuth are not believed",
          "[rte][reflect]") {
    const rte::Stack stack{.base = rte::henyey_greenstein_optics(0.99, 0.97)};
    const rte::Directions one{{0.03}, {0.2}, {40}};
    // 16 and 24 nodes agree there to 1e-6 and are 1.2e-3 off.
    const auto result = rte::reflect(stack, one, {.tolerance = 1e-5, .streams = 24});
    const auto truth = rte::reflect(stack, one, {.tolerance = 1e-8, .streams = 96});
    REQUIRE(result.reflection.size() == 1);
    const double error = std::abs(result.reflection[0] / truth.reflection[0] - 1);
    CHECK(error > 1e-4);
    CHECK_FALSE(result.report.converged);
    CHECK(error <= 3 * result.report.error_estimate);
    CHECK(result.report.worst_value == 0);
    CHECK(result.report.worst_azimuth_deg == 40.0);
}

TEST_CASE("grazing light from thin coats on dark bases is within the tolerance", "[rte][reflect]") {
    // Such coats need nodes at cosines of the size of their depth.
    struct Scene {
        rte::Stack stack;
        rte::Directions directions;
    };
    const std::vector<Scene> scenes{
        {{.base = rte::henyey_greenstein_optics(0.000215, 0.853439),
          .coats = {{rte::henyey_greenstein_optics(0.99384257813706, 0.591257), 0.0002496389}}},
         {{0.1782}, {0.01}, {180.0}}},
        {{.base = rte::isotropic_optics(0.0082),
          .coats = {{rte::isotropic_optics(0.99999076), 0.002194}}},
         {{0.1921}, {0.1175, 0.0166}, {115.3}}},
        {{.coats = {{rte::isotropic_optics(0.8338), 0.0011397}},
          .base_kind = rte::BaseKind::lambertian,
          .ground_albedo = 1.0},
         {{0.01137}, {0.9416, 0.01097}, {180.0}}}};
    for (const auto& [stack, directions] : scenes) {
        const auto truth = rte::reflect(stack, directions, {.tolerance = 1e-10, .streams = 96});
        const auto found = rte::reflect(stack, directions, {.tolerance = 1e-4});
        const double largest = *std::max_element(truth.reflection.begin(), truth.reflection.end());
        CHECK(found.report.converged);
        for (std::size_t k = 0; k < truth.reflection.size(); ++k)
            CHECK(std::abs(found.reflection[k] - truth.reflection[k]) <= 1e-4 * largest);
    }
}

TEST_CASE("reflection is reciprocal to rounding", "[rte][reflect]") {
    const rte::Stack stack{.base = rte::henyey_greenstein_optics(0.99, 0.75),
                           .coats = {{rte::henyey_greenstein_optics(0.6, 0.2), 0.3}}};
    const std::vector<double> mu{1e-4, 0.02, 0.3, 0.77, 1.0};
    const auto table =
        rte::reflect(stack, {mu, mu, {0.0, 40.0, 180.0}}, {.tolerance = 1e-6, .streams = 20});
    const auto at = [&](std::size_t i, std::size_t o, std::size_t a) {
        return table.reflection[(i * mu.size() + o) * 3 + a];
    };
    for (std::size_t i = 0; i < mu.size(); ++i) {
        for (std::size_t o = 0; o < i; ++o) {
            for (std::size_t a = 0; a < 3; ++a) {
                CHECK(std::abs(at(i, o, a) - at(o, i, a)) <= 1e-13 * std::abs(at(i, o, a)));
            }
        }
    }
}

TEST_CASE("integrating the reflection over the hemisphere gives the plane albedo",
          "[rte][reflect]") {
    const rte::Stack stack{.base = rte::henyey_greenstein_optics(0.9, 0.5),
                           .coats = {{rte::rayleigh_optics(0.7), 0.4}}};
    const auto grid = rte::make_mapped_gauss_grid(40);
    const std::vector<double> mu_out(grid.mu.data(), grid.mu.data() + grid.size());
    std::vector<double> azimuths;
    const int count = 64;  // the rectangle rule is exact for orders below 64
    for (int a = 0; a < count; ++a) azimuths.push_back(360.0 * a / count);
    const rte::SolverOptions options{.tolerance = 1e-11, .streams = 32};
    const double mu_in = GENERATE(0.05, 0.6, 1.0);
    const auto table = rte::reflect(stack, {{mu_in}, mu_out, azimuths}, options);
    double flux = 0.0;
    for (std::size_t o = 0; o < mu_out.size(); ++o) {
        double mean = 0.0;
        for (int a = 0; a < count; ++a) mean += table.reflection[o * count + a] / count;
        flux += 2.0 * grid.weights[o] * mu_out[o] * mean;
    }
    // 40 mapped nodes integrate the smooth order 0 to about 1e-10 of its value.
    CHECK(flux == Approx(rte::albedo(stack, {mu_in}, options).plane_albedo[0]).epsilon(1e-9));
}

TEST_CASE("only order 0 is computed when it is all there is", "[rte][reflect]") {
    const rte::Stack stack{.base = rte::henyey_greenstein_optics(0.9, 0.5)};
    const rte::SolverOptions options{.streams = 16};
    CHECK(rte::reflect(stack, {{1.0}, {0.2, 0.5}, {0.0, 90.0}}, options).report.fourier_orders ==
          1);
    CHECK(rte::reflect(stack, {{0.2, 0.5}, {1.0}, {0.0}}, options).report.fourier_orders == 1);
    CHECK(rte::reflect(stack, {{0.2}, {0.5}, {0.0}}, options).report.fourier_orders > 3);
    const rte::Stack isotropic{.base = rte::isotropic_optics(0.9)};
    CHECK(rte::reflect(isotropic, {{0.2}, {0.5}, {0.0}}, options).report.fourier_orders == 1);
    const rte::Stack rayleigh{.base = rte::rayleigh_optics(0.9)};
    CHECK(rte::reflect(rayleigh, {{0.2}, {0.5}, {0.0}}, options).report.fourier_orders == 3);
}

TEST_CASE("automatic choices meet the tolerance they report", "[rte][reflect]") {
    const double tolerance = GENERATE(1e-2, 1e-3, 1e-5);
    for (const char* file :
         {"R_halfspace_isotropic.csv", "R_halfspace_HG.csv", "R_coated_halfspace.csv"}) {
        for (const auto& reference : support::reflection_cases(file)) {
            rte::SolverReport report;
            const double error =
                support::largest_scaled_error(reference, {.tolerance = tolerance}, 0.0, &report);
            CAPTURE(file, reference.name, tolerance, report.streams, report.error_estimate);
            CHECK(report.converged);
            CHECK(error <= 3.0 * report.error_estimate);
            CHECK(error <= tolerance);
        }
    }
}

TEST_CASE("albedo 0 reflects nothing", "[rte][reflect]") {
    const rte::Stack black{.base = rte::henyey_greenstein_optics(0.0, 0.8)};
    for (const double reflection :
         rte::reflect(black, {{0.1, 1.0}, {0.4}, {0.0, 180.0}}).reflection) {
        CHECK(reflection == 0.0);
    }
    CHECK(rte::albedo(black, {0.5}).spherical_albedo == 0.0);
}

TEST_CASE("reflect refuses nonsense with the value in the message", "[rte][reflect][errors]") {
    const rte::Stack stack{.base = rte::isotropic_optics(0.9)};
    CHECK_THROWS_WITH(rte::reflect(stack, {{0.0}, {0.5}, {0.0}}),
                      Catch::Contains("mu_in") && Catch::Contains("(0, 1]"));
    CHECK_THROWS_WITH(rte::reflect(stack, {{0.5}, {1.5}, {0.0}}), Catch::Contains("1.5"));
    CHECK_THROWS_WITH(rte::reflect(stack, {{0.5}, {0.5}, {std::nan("")}}), Catch::Contains("nan"));
    CHECK_THROWS_WITH(rte::reflect(stack, {{0.5}, {0.5}, {0.0}}, {.streams = 1}),
                      Catch::Contains("2 to 256"));
    CHECK_THROWS_WITH(rte::reflect(stack, {{0.5}, {0.5}, {0.0}}, {.tolerance = 0.0}),
                      Catch::Contains("tolerance"));
    rte::Stack coated = stack;
    coated.coats = {{rte::isotropic_optics(0.5), -0.1}};
    CHECK_THROWS_WITH(rte::reflect(coated, {{0.5}, {0.5}, {0.0}}), Catch::Contains("-0.1"));
    coated.coats[0].optical_depth = std::nan("");
    CHECK_THROWS_WITH(rte::albedo(coated, {0.5}), Catch::Contains("nan"));
}

TEST_CASE("a reflection comes with the plane albedos of its own solution", "[rte][albedo]") {
    const rte::Stack stack{.base = rte::henyey_greenstein_optics(0.95, 0.6),
                           .coats = {{rte::henyey_greenstein_optics(0.8, 0.3), 0.2}}};
    const std::vector<double> mu_in{0.1, 0.6, 1.0};
    const rte::SolverOptions options{.tolerance = 1e-6, .streams = 24};
    const auto table = rte::reflect(stack, {mu_in, {0.3, 0.9}, {0.0, 90.0}}, options);
    const auto alone = rte::albedo(stack, mu_in, options);
    REQUIRE(table.plane_albedo.size() == 3);
    for (std::size_t i = 0; i < 3; ++i) {
        // Order 0 of the same equations: rounding only.
        CHECK(std::abs(table.plane_albedo[i] - alone.plane_albedo[i]) <= 1e-13);
    }
}

TEST_CASE("albedos through a boundary count what it lets in and out", "[rte][albedo]") {
    rte::Stack stack;
    stack.base = rte::henyey_greenstein_optics(0.95, 0.6);
    const auto boundary = [](double mu) {
        return rte::SurfaceWeights{.in = 0.3 + 0.6 * mu, .out = 1.2 - 0.5 * mu * mu};
    };
    const rte::SolverOptions options{.tolerance = 1e-8, .streams = 32};
    const auto rule = math::gauss_legendre(64, 0.0, 1.0);
    const auto through = rte::albedo(stack, rule.nodes, options, boundary);
    double entering = 0, returned = 0;
    for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
        const double weight = rule.weights[i] * rule.nodes[i] * boundary(rule.nodes[i]).in;
        entering += weight;
        returned += weight * through.plane_albedo[i];
    }
    // mu ln mu at grazing, 64 Gauss nodes: 1e-6.
    CHECK(std::abs(through.spherical_albedo - returned / entering) <= 1e-6);

    // One incidence from the reflection itself, averaged over azimuths.
    rte::Directions around{{0.35}, rule.nodes, {}};
    constexpr int azimuths = 48;  // 0.6^48 = 2e-11 of the orders alias
    for (int a = 0; a < azimuths; ++a) around.azimuth_deg.push_back(7.5 * a);
    const auto values = rte::reflect(stack, around, options).reflection;
    double counted = 0;
    for (std::size_t o = 0; o < rule.nodes.size(); ++o) {
        double mean = 0;
        for (int a = 0; a < azimuths; ++a) mean += values[o * azimuths + std::size_t(a)] / azimuths;
        counted += 2 * rule.weights[o] * rule.nodes[o] * boundary(rule.nodes[o]).out * mean;
    }
    const auto at_one = rte::albedo(stack, {0.35}, options, boundary);
    CHECK(std::abs(at_one.plane_albedo[0] - counted) <= 1e-6);
}

TEST_CASE("a boundary that lets nothing in gives albedo 0, not 0 / 0", "[rte][albedo]") {
    rte::Stack stack;
    stack.base = rte::isotropic_optics(0.9);
    const auto mirror = [](double) { return rte::SurfaceWeights{.in = 0, .out = 0}; };
    CHECK(rte::albedo(stack, {0.5}, {}, mirror).spherical_albedo == 0.0);
}

TEST_CASE("an incidence gets its orders whatever brighter ones it is asked for with",
          "[rte][layered]") {
    // A peak in both directions: light comes back at azimuth 180 in many orders.
    rte::Optics optics;
    optics.single_scattering_albedo = 0.9;
    optics.one_minus_albedo = 0.1;
    for (int l = 1; l < 400; ++l) {
        optics.chi.push_back(0.7 * std::pow(0.97, l) + 0.3 * std::pow(-0.97, l));
    }
    const rte::Stack stack{.base = optics,
                           .coats = {{rte::henyey_greenstein_optics(0.3, 0.9), 0.1}}};
    const rte::SolverOptions options{.tolerance = 1e-3, .streams = 64};
    const double mu = GENERATE(0.05, 0.1, 0.2);
    const auto alone = rte::reflect(stack, {{mu}, {mu}, {0.0, 175.0, 180.0}}, options);
    const auto beside = rte::reflect(stack, {{mu, 1.0}, {mu, 1.0}, {0.0, 175.0, 180.0}}, options);
    const double scale = *std::max_element(alone.reflection.begin(), alone.reflection.end());
    for (std::size_t k = 0; k < alone.reflection.size(); ++k) {
        CAPTURE(mu, k, alone.report.fourier_orders, beside.report.fourier_orders);
        // Each may leave out a quarter of the tolerance.
        CHECK(std::abs(alone.reflection[k] - beside.reflection[k]) <=
              0.5 * options.tolerance * scale);
    }
}

TEST_CASE(
    "a watch sees every number of nodes but the last, changes nothing, and may end the search",
    "[rte][reflect]") {
    const rte::Stack stack{.base = rte::henyey_greenstein_optics(0.99, 0.9)};
    const rte::Directions directions{{0.1, 0.6}, {0.2, 0.9}, {0, 90, 180}};
    const rte::SolverOptions options{.tolerance = 1e-5};
    const auto plain = rte::reflect(stack, directions, options);
    std::vector<int> seen, announced;
    const auto watched = rte::reflect(stack, directions, options, nullptr,
                                      [&](const rte::SolverReport& report, int next) {
                                          CHECK(report.error_estimate > options.tolerance);
                                          seen.push_back(report.streams);
                                          announced.push_back(next);
                                          return true;
                                      });
    CHECK(watched.reflection == plain.reflection);
    REQUIRE(seen.size() >= 2);
    CHECK(announced.back() == plain.report.streams);
    for (std::size_t i = 0; i + 1 < seen.size(); ++i) CHECK(announced[i] == seen[i + 1]);
    const auto cut = rte::reflect(stack, directions, options, nullptr,
                                  [](const rte::SolverReport&, int) { return false; });
    CHECK(cut.report.streams == seen.front());
    CHECK_FALSE(cut.report.converged);
}

TEST_CASE("estimates of single values hold", "[rte][reflect]") {
    std::mt19937 random(7);
    const auto uniform = [&](double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(random);
    };
    const rte::Directions directions{
        {0.1, 0.4, 0.9}, {0.07, 0.3, 0.6, 0.8, 1.0}, {0, 30, 60, 90, 120, 150, 180}};
    const std::size_t block = directions.mu_out.size() * directions.azimuth_deg.size();
    std::size_t values = 0, beyond = 0, far_beyond = 0;
    for (int scene = 0; scene < 40; ++scene) {
        rte::Stack stack{.base =
                             rte::henyey_greenstein_optics(uniform(0.3, 1.0), uniform(-0.3, 0.95))};
        if (scene % 3 == 0) {
            stack.coats = {{rte::henyey_greenstein_optics(uniform(0.3, 1.0), uniform(0.0, 0.8)),
                            std::pow(10.0, uniform(-2.0, 1.0))}};
        }
        const auto truth = rte::reflect(stack, directions, {.tolerance = 1e-9, .streams = 96});
        for (const double tolerance : {1e-2, 1e-3, 1e-5}) {
            const auto result = rte::reflect(stack, directions, {.tolerance = tolerance});
            REQUIRE(result.errors.size() == result.reflection.size());
            CHECK(*std::max_element(result.errors.begin(), result.errors.end()) ==
                  result.report.error_estimate);
            for (std::size_t k = 0; k < result.errors.size(); ++k) {
                const auto first = truth.reflection.begin() + std::ptrdiff_t(k - k % block);
                const double largest = *std::max_element(first, first + std::ptrdiff_t(block));
                const double error = std::abs(result.reflection[k] - truth.reflection[k]) / largest;
                // Moments that are left out show as a tenth of the tolerance at most, in no
                // comparison.
                const double stated = std::max(result.errors[k], 0.1 * tolerance);
                ++values;
                if (!(error <= stated)) ++beyond;
                if (!(error <= 3 * stated)) ++far_beyond;
            }
        }
    }
    CAPTURE(values, beyond, far_beyond);
    // Estimates of two or three solutions are statistics.
    CHECK(double(beyond) <= 0.01 * double(values));
    CHECK(double(far_beyond) <= 0.001 * double(values));
}

TEST_CASE("the estimate of a single value is that of its probes, too", "[rte][reflect]") {
    const auto one = rte::reflect({.base = rte::henyey_greenstein_optics(0.99, 0.97)},
                                  {{0.03}, {0.2}, {40}}, {.tolerance = 1e-5, .streams = 24});
    REQUIRE(one.errors.size() == 1);
    CHECK(one.errors[0] == one.report.error_estimate);
    CHECK(one.steps_converged);
    CHECK_FALSE(one.report.converged);
}
