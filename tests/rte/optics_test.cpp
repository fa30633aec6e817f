#include <miebrdf/optics.h>

#include <cmath>

#include <miebrdf/error.h>
#include "rte/math/legendre.h"
#include "rte/math/quadrature.h"
#include "rte/phase/scaled_medium.h"
#include "tests/support/catch.h"

using namespace miebrdf;

TEST_CASE("Henyey-Greenstein moments are those of its phase function", "[rte][optics]") {
    const double g = GENERATE(-0.7, 0.0, 0.3, 0.85);
    const auto optics = rte::henyey_greenstein_optics(0.5, g);
    const auto rule = math::gauss_legendre(400, -1.0, 1.0);
    for (std::size_t l = 0; l < std::min<std::size_t>(20, optics.chi.size()); ++l) {
        std::vector<double> only(l + 1, 0.0);
        only[l] = 1.0 / (2.0 * double(l) + 1.0);
        double chi = 0.0;
        for (std::size_t k = 0; k < rule.nodes.size(); ++k) {
            chi += 0.5 * rule.weights[k] * optics.phase(rule.nodes[k]) *
                   math::legendre_series(only, rule.nodes[k]);
        }
        CAPTURE(g, l);
        // 400 Gauss nodes resolve the peak of g = 0.85 to rounding.
        CHECK(std::abs(chi - optics.chi[l]) <= 1e-13);
    }
}

TEST_CASE("the phase function is the sum of its moments", "[rte][optics]") {
    const double g = GENERATE(-0.9, 0.0, 0.5, 0.9);
    const auto optics = rte::henyey_greenstein_optics(0.5, g);
    const double x = GENERATE(-1.0, -0.3, 0.0, 0.9, 1.0);
    const double exact = optics.phase(x);
    CAPTURE(g, x);
    // The moments stop at (2l+1) |chi| = 1e-17; terms of both signs as large as the peak cancel.
    CHECK(std::abs(math::legendre_series(optics.chi, x) - exact) <=
          1e-13 * optics.phase(g < 0 ? -1 : 1));
}

TEST_CASE("validate refuses impossible optics with the value in the message",
          "[rte][optics][errors]") {
    rte::Optics optics;
    optics.single_scattering_albedo = 1.5;
    CHECK_THROWS_WITH(rte::validate(optics), Catch::Contains("1.5") && Catch::Contains("[0, 1]"));
    optics.single_scattering_albedo = std::nan("");
    CHECK_THROWS_WITH(rte::validate(optics), Catch::Contains("nan"));
    optics = rte::isotropic_optics(0.5);
    optics.one_minus_albedo = 0.4;
    CHECK_THROWS_WITH(rte::validate(optics), Catch::Contains("0.4"));
    optics = rte::isotropic_optics(0.5);
    optics.chi = {0.9};
    CHECK_THROWS_WITH(rte::validate(optics), Catch::Contains("0.9"));
    optics.chi = {};
    CHECK_THROWS_AS(rte::validate(optics), UsageError);
    optics.chi = {1.0, 0.5, -1.2};
    CHECK_THROWS_WITH(rte::validate(optics), Catch::Contains("chi[2]") && Catch::Contains("-1.2"));
    CHECK_THROWS_WITH(rte::henyey_greenstein_optics(0.5, 1.0), Catch::Contains("(-1, 1)"));
    CHECK_NOTHROW(rte::validate(rte::rayleigh_optics(1.0)));
}

TEST_CASE("delta-M keeps absorption's digits and every moment within bounds", "[rte][delta_m]") {
    rte::Optics optics = rte::henyey_greenstein_optics(1.0, GENERATE(-0.99, -0.5, 0.5, 0.9, 0.999));
    optics.single_scattering_albedo = 1.0 - 1e-15;
    optics.one_minus_albedo = 1e-15;
    const int moments = GENERATE(1, 2, 5, 16, 65);
    const auto scaled = rte::scale_optics(optics, moments, true);
    CHECK(scaled.chi[0] == 1.0);
    CHECK(scaled.chi.cwiseAbs().maxCoeff() <= 1.0);
    // (1 - alpha) / (1 - alpha f): two roundings.
    CHECK(std::abs(scaled.one_minus_albedo * scaled.depth_factor / 1e-15 - 1.0) <= 1e-15);
    CHECK(scaled.one_minus_albedo + scaled.albedo == Approx(1.0).epsilon(1e-15));
}

TEST_CASE("a mixture averages albedos by extinction and phase functions by scattering",
          "[rte][optics]") {
    const auto hg = rte::henyey_greenstein_optics(0.9, 0.8);
    const auto rayleigh = rte::rayleigh_optics(0.3);
    const auto mixture = rte::mix({{hg, 1.0}, {rayleigh, 3.0}});
    CHECK(mixture.single_scattering_albedo == Approx(0.25 * 0.9 + 0.75 * 0.3).epsilon(1e-15));
    const double from_hg = 0.25 * 0.9 / mixture.single_scattering_albedo;
    CHECK(mixture.chi[1] == Approx(from_hg * 0.8).epsilon(1e-14));
    CHECK(mixture.chi[2] == Approx(from_hg * 0.64 + (1 - from_hg) * 0.1).epsilon(1e-14));
    for (const double x : {-1.0, 0.2, 1.0}) {
        // Both forms of P; the series stops at terms below 1e-17.
        CHECK(mixture.phase(x) == Approx(math::legendre_series(mixture.chi, x)).epsilon(1e-12));
    }
    CHECK_NOTHROW(rte::validate(mixture));
    CHECK_NOTHROW(rte::validate(rte::mix({{rte::isotropic_optics(0.0), 1.0}})));
    CHECK_THROWS_AS(rte::mix({}), UsageError);
    CHECK_THROWS_WITH(rte::mix({{hg, -1.0}}), Catch::Contains("-1"));
}

TEST_CASE("mixtures of media that absorb nothing absorb nothing, in any shares", "[rte][optics]") {
    // Shares of the extinction add up to more than 1 by rounding in a third of these.
    const rte::Optics white = rte::henyey_greenstein_optics(1.0, 0.3),
                      molecules = rte::rayleigh_optics(1.0);
    for (int i = 1; i <= 200; ++i) {
        const double a = 0.37 * i, b = 1.0 / i;
        const rte::Optics mixture =
            rte::mix({{white, a}, {molecules, b}, {rte::isotropic_optics(1.0), a * b}});
        CAPTURE(i);
        CHECK(mixture.single_scattering_albedo == 1.0);
        CHECK(mixture.one_minus_albedo == 0.0);
        CHECK_NOTHROW(rte::validate(mixture));
    }
}
