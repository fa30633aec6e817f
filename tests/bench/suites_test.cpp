// The suites themselves: truths are there, and methods that must be right are.
#include "tools/bench/suites.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "tests/support/catch.h"

using namespace miebrdf;

TEST_CASE("every suite has truths, contenders and a source for each", "[bench][suites]") {
    for (const auto& [suite, cases] : bench::kSuites) {
        const std::string name = suite;
        for (const auto& c : cases()) {
            CAPTURE(name, c.name);
            CHECK(c.suite == name);
            CHECK_FALSE(c.truth.empty());
            CHECK_FALSE(c.true_values.empty());
            CHECK(std::all_of(c.true_values.begin(), c.true_values.end(),
                              [](double v) { return v > 0; }));
            // A rule has two: with it and without.
            CHECK(c.contenders.size() >= (name == "rules" ? 2 : 6));
        }
    }
}

TEST_CASE("what a rule leaves out does not show", "[bench][suites]") {
    for (const auto& c : bench::rules_suite()) {
        CAPTURE(c.name);
        REQUIRE(c.contenders.size() == 2);
        // The tolerance of the requests, once for each of the two; 32 nodes for the integral.
        CHECK(bench::largest_relative_error(c.contenders[1].run().values, c.true_values) <= 2e-3);
    }
}

TEST_CASE("in the half-space suite the closed form beats the short cuts", "[bench][suites]") {
    const auto c = bench::half_space_suite().front();
    double best = 1, kubelka_munk = 0, paper = 1, photons = 1;
    for (const auto& contender : c.contenders) {
        if (contender.parameter.find("10000") != std::string::npos) {
            photons = bench::largest_relative_error(contender.run().values, c.true_values);
        }
        if (contender.method == "Monte Carlo" || contender.method == "adding-doubling") continue;
        const double error = bench::largest_relative_error(contender.run().values, c.true_values);
        if (contender.method == "closed form, mapped Gauss") best = std::min(best, error);
        if (contender.method == "Kubelka-Munk") kubelka_munk = error;
        if (contender.method == "paper: eq. 3 on its grid") paper = std::min(paper, error);
    }
    // Mapped Gauss with 32 nodes resolves isotropic scattering to rounding, which 64 nodes add up.
    CHECK(best <= 1e-14);
    // The paper's iteration on its grid of 32 nodes: 9.4e-9 seen.
    CHECK(paper <= 5e-8);
    // A constant for a function that varies by a factor of 3 over these directions.
    CHECK(kubelka_munk >= 0.2);
    // 10,000 photons: 1 % a piece, largest of 16, a factor of 1.5 at grazing.
    CHECK(photons <= 0.05);
}

TEST_CASE("the surface suite's truth owes nothing to the solver and agrees with it",
          "[bench][suites]") {
    for (const auto& c : bench::surface_suite()) {
        CAPTURE(c.name);
        for (const auto& contender : c.contenders) {
            if (contender.method != "miebrdf") continue;
            CAPTURE(contender.parameter);
            const double tolerance = std::stod(contender.parameter.substr(4));
            // Both are adaptive; the truth to 1e-11.
            CHECK(bench::largest_relative_error(contender.run().values, c.true_values) <=
                  tolerance + 1e-10);
        }
        // Three standard deviations of the largest of four.
        const auto rays = c.contenders.back().run();
        REQUIRE(rays.half_widths.size() == rays.values.size());
        for (std::size_t i = 0; i < rays.values.size(); ++i)
            CHECK(std::abs(rays.values[i] - c.true_values[i]) <= 2 * rays.half_widths[i]);
    }
}
