// Photons: their random numbers, their scattering angles, and where they go.
#include <boost/math/quadrature/gauss_kronrod.hpp>

#include <cmath>

#include "tests/support/catch.h"
#include "tests/support/reference_table.h"
#include "tools/bench/photon_tracer.h"

using namespace miebrdf;

TEST_CASE("Philox4x32-10 gives the known answers of its authors", "[bench][random]") {
    // kat_vectors of the Random123 distribution (Salmon et al. 2011).
    CHECK(bench::philox({0, 0, 0, 0}, {0, 0}) ==
          bench::PhiloxCounter{0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8});
    CHECK(
        bench::philox({0xffffffff, 0xffffffff, 0xffffffff, 0xffffffff}, {0xffffffff, 0xffffffff}) ==
        bench::PhiloxCounter{0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd});
    CHECK(
        bench::philox({0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344}, {0xa4093822, 0x299f31d0}) ==
        bench::PhiloxCounter{0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1});
}

TEST_CASE("streams are reproducible, different and uniform", "[bench][random]") {
    bench::RandomStream a(7, 1), again(7, 1), other(7, 2);
    double sum = 0, squares = 0, product = 0;
    const int n = 100000;
    for (int i = 0; i < n; ++i) {
        const double u = a.uniform(), v = other.uniform();
        REQUIRE(u == again.uniform());
        REQUIRE((u > 0 && u < 1));
        sum += u;
        squares += u * u;
        product += u * v;
    }
    // Five standard errors: sqrt(1/12), sqrt(4/45) and sqrt(7/144) over sqrt(n).
    CHECK(std::abs(sum / n - 0.5) <= 5 * std::sqrt(1.0 / 12 / n));
    CHECK(std::abs(squares / n - 1.0 / 3) <= 5 * std::sqrt(4.0 / 45 / n));
    CHECK(std::abs(product / n - 0.25) <= 5 * std::sqrt(7.0 / 144 / n));
}

using bench::ScatteringLaw;

namespace {

ScatteringLaw some_law(int which) {
    switch (which) {
        case 0:
            return ScatteringLaw::isotropic();
        case 1:
            return ScatteringLaw::rayleigh();
        case 2:
            return ScatteringLaw::henyey_greenstein(0.75);
        case 3:
            return ScatteringLaw::henyey_greenstein(-0.4);
        default:
            return ScatteringLaw::tabulated({-1, -0.5, 0.2, 0.9, 1}, {1, 0, 0.5, 2, 30});
    }
}

}  // namespace

TEST_CASE("sampling inverts the distribution of the phase function", "[bench][law]") {
    const int which = GENERATE(0, 1, 2, 3, 4);
    const auto law = some_law(which);
    const auto fraction_below = [&](double x) {
        double sum = 0;
        // Piecewise, because a table has kinks.
        const double kinks[] = {-1, -0.5, 0.2, 0.9, 1};
        for (int i = 0; i < 4; ++i) {
            const double from = kinks[i], to = std::min(x, kinks[i + 1]);
            if (to <= from) break;
            sum += boost::math::quadrature::gauss_kronrod<double, 31>::integrate(
                [&](double t) { return law.value(t) / 2; }, from, to, 10, 1e-13);
        }
        return sum;
    };
    CAPTURE(which);
    CHECK(std::abs(fraction_below(1.0) - 1) <= 1e-12);
    for (const double u : {1e-6, 0.01, 0.2, 0.5, 0.77, 0.99, 1 - 1e-6}) {
        // Quadrature to 1e-13; the inverse of a steep distribution costs a digit or two.
        CHECK(std::abs(fraction_below(law.sample(u)) - u) <= 1e-11);
    }
}

TEST_CASE("laws that no light could follow are refused", "[bench][law][errors]") {
    CHECK_THROWS_WITH(ScatteringLaw::henyey_greenstein(1.0), Catch::Contains("(-1, 1)"));
    CHECK_THROWS_AS(ScatteringLaw::tabulated({-1, 1}, {1, -1}), std::invalid_argument);
    CHECK_THROWS_AS(ScatteringLaw::tabulated({-1, 0.5}, {1, 1}), std::invalid_argument);
    CHECK_THROWS_AS(ScatteringLaw::tabulated({-1, 1}, {0, 0}), std::invalid_argument);
}

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
        // Both draw one sequence of random numbers: paths differ by the table's error, at most (0.1
        // degrees)^2 P'' ~ 1e-4 near the peak, until a rare roulette decision falls the other way.
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
