#include <cmath>

#include "rte/stack/layered_reflection.h"
#include "tests/support/catch.h"

using namespace miebrdf;

TEST_CASE("any asymmetry, albedo and number of nodes gives finite, reciprocal, positive light",
          "[rte][extremes]") {
    const double g = GENERATE(-0.99, -0.7, 0.0, 0.95, 0.999);
    const double albedo = GENERATE(1e-9, 0.5, 1.0 - 1e-12, 1.0);
    const int streams = GENERATE(2, 3, 16);
    const rte::Stack stack{.base = rte::henyey_greenstein_optics(albedo, g)};
    const std::vector<double> mu{1e-4, 0.3, 1.0};
    const rte::SolverOptions options{.tolerance = 1e-3, .streams = streams};
    const auto table = rte::reflect(stack, {mu, mu, {0.0, 180.0}}, options);
    const auto albedos = rte::albedo(stack, mu, options);
    CAPTURE(g, albedo, streams, table.report.moments, table.report.error_estimate);
    double largest = 0.0;
    for (const double value : table.reflection) largest = std::max(largest, std::abs(value));
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t o = 0; o < 3; ++o) {
            for (std::size_t a = 0; a < 2; ++a) {
                const double value = table.reflection[(i * 3 + o) * 2 + a];
                CHECK(std::isfinite(value));
                CHECK(std::abs(value - table.reflection[(o * 3 + i) * 2 + a]) <=
                      1e-12 * std::abs(value) + 1e-15 * largest);
            }
        }
        // Two nodes and four moments cannot keep every direction positive: -2.3e-4 seen.
        CHECK(albedos.plane_albedo[i] >= (streams == 2 ? -5e-4 : -1e-12));
        CHECK(albedos.plane_albedo[i] <= 1.0 + 1e-12);
        if (albedo == 1.0) CHECK(std::abs(albedos.plane_albedo[i] - 1.0) <= 1e-12);
    }
}

TEST_CASE("coats from 1e-12 to infinite optical depth on any base stay physical",
          "[rte][extremes]") {
    const double tau = GENERATE(1e-12, 1e-3, 1e3, 1e12, 1e300, HUGE_VAL);
    const double coat_albedo = GENERATE(0.0, 0.9, 1.0);
    const auto base =
        GENERATE(rte::BaseKind::half_space, rte::BaseKind::lambertian, rte::BaseKind::none);
    const rte::Stack stack{.base = rte::henyey_greenstein_optics(1.0, 0.8),
                           .coats = {{rte::henyey_greenstein_optics(coat_albedo, 0.6), tau}},
                           .base_kind = base,
                           .ground_albedo = 1.0};
    const auto albedos = rte::albedo(stack, {1e-4, 0.5, 1.0}, {.tolerance = 1e-6, .streams = 16});
    CAPTURE(tau, coat_albedo, int(base));
    for (const double plane : albedos.plane_albedo) {
        CHECK(plane >= -1e-14);
        CHECK(plane <= 1.0 + 1e-12);
        // White on white loses nothing, whatever lies between.
        if (coat_albedo == 1.0 && base != rte::BaseKind::none)
            CHECK(std::abs(plane - 1.0) <= 1e-12);
    }
}

TEST_CASE("albedos and transmittances below 1e-6 of the incident flux need no digits",
          "[rte][extremes]") {
    // Relative to e^-110 any number of nodes would err by more than the tolerance.
    const double depth = GENERATE(11.0, 55.0, 110.0);
    const rte::Stack dark{.coats = {{rte::isotropic_optics(0.4), depth, 1.5}},
                          .base_kind = rte::BaseKind::lambertian,
                          .ground_albedo = 0.2,
                          .boundary = rte::Boundary{}};
    const auto deep = rte::albedo(dark, {0.5});
    CAPTURE(depth, deep.report.streams, deep.report.error_estimate);
    CHECK(deep.report.converged);
    CHECK(deep.report.streams <= 16);
    if (depth > 50.0) CHECK(deep.transmittance[0] <= 1e-12);
    const auto nothing = rte::albedo(
        {.coats = {{rte::isotropic_optics(0.0), 0.1}}, .base_kind = rte::BaseKind::none}, {0.5});
    CHECK(nothing.report.converged);
    CHECK(nothing.report.error_estimate <= 1e-3);
    CHECK(std::abs(nothing.plane_albedo[0]) <= 1e-15);
}

TEST_CASE("a transmittance of 1e-5 has the digits that the tolerance asks for", "[rte][extremes]") {
    const rte::Stack stack{.coats = {{rte::henyey_greenstein_optics(0.6, 0.7), 14.0}},
                           .base_kind = rte::BaseKind::none};
    const auto exact = rte::albedo(stack, {0.5}, {.tolerance = 1e-9, .streams = 64});
    const auto found = rte::albedo(stack, {0.5}, {.tolerance = 1e-4});
    REQUIRE(exact.transmittance[0] > 1e-6);
    REQUIRE(exact.transmittance[0] < 1e-3);
    CAPTURE(exact.transmittance[0]);
    CHECK(std::abs(found.transmittance[0] / exact.transmittance[0] - 1.0) <= 1e-4);
}
