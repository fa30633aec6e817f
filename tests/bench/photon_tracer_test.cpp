// The tracer against tables that owe nothing to it (tests/reference/rte).
#include "tools/bench/photon_tracer.h"

#include <cmath>

#include "tests/support/catch.h"
#include "tests/support/reference_table.h"

using namespace miebrdf;
using bench::ScatteringLaw;

namespace {

// Some hundred comparisons are made with fixed seeds: the chance that one of them is off by more
// than 4.5 standard errors is below 1e-3 for Gaussian noise.
constexpr double kSigmas = 4.5;

}  // namespace

TEST_CASE("photons reproduce the H-function of an isotropic half-space", "[bench][tracer]") {
    const support::ReferenceTable table("rte/R_halfspace_isotropic.csv");
    for (const double albedo : {0.5, 0.9}) {
        std::vector<bench::Detector> detectors;
        std::vector<double> truth;
        for (std::size_t row = 0; row < table.size(); ++row) {
            if (table.number(row, "alpha") != albedo || table.number(row, "mu_i") != 0.5) continue;
            if (table.number(row, "phi_deg") != 0) continue;
            detectors.push_back({table.number(row, "mu_o"), 0});
            truth.push_back(table.number(row, "R"));
        }
        REQUIRE(detectors.size() >= 4);
        bench::TracedStack stack;
        stack.base.single_scattering_albedo = albedo;
        const auto traced = bench::trace_photons(stack, 0.5, detectors, {.photons = 40000});
        for (std::size_t i = 0; i < truth.size(); ++i) {
            CAPTURE(albedo, detectors[i].mu_out, truth[i], traced.reflection[i].value,
                    traced.reflection[i].standard_error);
            CHECK(traced.reflection[i].agrees_with(truth[i], kSigmas));
            CHECK(traced.reflection[i].standard_error <= 0.02 * truth[i]);
        }
    }
}

TEST_CASE("photons reproduce Rayleigh and Henyey-Greenstein half-spaces with azimuth",
          "[bench][tracer]") {
    const bool rayleigh = GENERATE(true, false);
    const support::ReferenceTable table(rayleigh ? "rte/R_halfspace_rayleigh.csv"
                                                 : "rte/R_halfspace_HG.csv");
    bench::TracedStack stack;
    stack.base.single_scattering_albedo = 0.9;
    stack.base.law = rayleigh ? ScatteringLaw::rayleigh() : ScatteringLaw::henyey_greenstein(0.5);
    std::vector<bench::Detector> detectors;
    std::vector<double> truth;
    for (std::size_t row = 0; row < table.size(); ++row) {
        if (table.number(row, "alpha") != 0.9 || table.number(row, "mu_i") != 0.35) continue;
        if (!rayleigh && table.number(row, "g") != 0.5) continue;
        detectors.push_back({table.number(row, "mu_o"), table.number(row, "phi_deg")});
        truth.push_back(table.number(row, "R"));
    }
    REQUIRE(detectors.size() >= 20);
    const auto traced = bench::trace_photons(stack, 0.35, detectors, {.photons = 20000, .seed = 5});
    for (std::size_t i = 0; i < truth.size(); ++i) {
        CAPTURE(rayleigh, detectors[i].mu_out, detectors[i].azimuth_deg, truth[i],
                traced.reflection[i].value, traced.reflection[i].standard_error);
        CHECK(traced.reflection[i].agrees_with(truth[i], kSigmas));
    }
}

TEST_CASE("photons reproduce the plane albedo of coated half-spaces", "[bench][tracer]") {
    const support::ReferenceTable table("rte/albedo_coated_halfspace.csv");
    int compared = 0;
    for (std::size_t row = 0; row < table.size(); ++row) {
        if (table.text(row, "quantity") != "plane_albedo") continue;
        const double mu = table.number(row, "mu_i"), tau = table.number(row, "tau");
        if ((mu != 0.2 && mu != 0.8) || tau > 2) continue;
        // Base of every row: HG albedo 0.95, g = 0.7 (header of the table).
        bench::TracedStack stack;
        stack.base = {0.95, ScatteringLaw::henyey_greenstein(0.7), 0};
        if (tau > 0) {
            stack.coats.push_back({table.number(row, "coat_alpha"),
                                   ScatteringLaw::henyey_greenstein(table.number(row, "coat_g")),
                                   tau});
        }
        const auto traced = bench::trace_photons(stack, mu, {}, {.photons = 10000});
        const double truth = table.number(row, "value");
        CAPTURE(row, mu, tau, truth, traced.plane_albedo.value, traced.plane_albedo.standard_error);
        CHECK(traced.plane_albedo.agrees_with(truth, kSigmas));
        ++compared;
    }
    CHECK(compared >= 10);
}

TEST_CASE("a table of a phase function traces like the function", "[bench][tracer]") {
    const auto law = ScatteringLaw::henyey_greenstein(0.7);
    std::vector<double> x, p;
    for (int i = 0; i <= 1800; ++i) {
        x.push_back(i == 0 ? -1 : i == 1800 ? 1 : -std::cos(i * M_PI / 1800));
        p.push_back(law.value(x.back()));
    }
    bench::TracedStack exact, tabulated;
    exact.base = {0.9, law, 0};
    tabulated.base = {0.9, ScatteringLaw::tabulated(x, p), 0};
    const std::vector<bench::Detector> detectors{{0.3, 0}, {0.8, 120}};
    const bench::TracerOptions options{.photons = 20000};
    const auto a = bench::trace_photons(exact, 0.5, detectors, options);
    const auto b = bench::trace_photons(tabulated, 0.5, detectors, options);
    for (std::size_t i = 0; i < detectors.size(); ++i) {
        // The same random numbers: paths differ by the table's error, at most (0.1 degrees)^2 P'' ~
        // 1e-4 near the peak, until a rare roulette decision falls the other way.
        const double noise = a.reflection[i].standard_error;
        CHECK(std::abs(a.reflection[i].value - b.reflection[i].value) <= noise);
    }
}

TEST_CASE("what the tracer gives up is told, and results are the same bits again",
          "[bench][tracer]") {
    bench::TracedStack white;
    white.base.single_scattering_albedo = 1;
    const bench::TracerOptions options{.photons = 2000, .most_collisions = 100};
    const auto traced = bench::trace_photons(white, 0.5, {{0.5, 0}}, options);
    CHECK(traced.plane_albedo.unfinished > 0);
    // A conservative half-space reflects everything: weight is either out or given up.
    CHECK(std::abs(traced.plane_albedo.value + traced.plane_albedo.unfinished - 1) <= 1e-12);
    CHECK(traced.plane_albedo.agrees_with(1.0, kSigmas));
    const auto again = bench::trace_photons(white, 0.5, {{0.5, 0}}, options);
    CHECK(again.plane_albedo.value == traced.plane_albedo.value);
    CHECK(again.reflection[0].value == traced.reflection[0].value);
    CHECK_THROWS_WITH(bench::trace_photons(white, 0.0, {}), Catch::Contains("(0, 1]"));
}
