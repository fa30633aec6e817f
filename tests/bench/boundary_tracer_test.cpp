// Photons at boundaries: the tracer against closed forms and a table of another random walk.
#include <cmath>

#include "tests/support/catch.h"
#include "tests/support/reference_table.h"
#include "tools/bench/photon_tracer.h"

using namespace miebrdf;
using bench::RayDirection;
using bench::ScatteringLaw;
using bench::TracedBoundary;

namespace {

constexpr double kStandardErrors = 4.5;  // as in photon_tracer_test.cpp

struct Share {
    double value, standard_error;
};

/// The share of diffuse light from one side that the boundary sends back there.
Share diffuse_reflectance(const TracedBoundary& boundary, bool from_air, int rays) {
    int back = 0;
    for (int i = 0; i < rays; ++i) {
        bench::RandomStream random(3, static_cast<std::uint64_t>(i));
        const double mu2 = random.uniform(), mu = std::sqrt(mu2);
        const RayDirection ray{std::sqrt(1 - mu2), 0, from_air ? mu : -mu};
        back += bench::meet_boundary(boundary, from_air, ray, random).into_medium != from_air;
    }
    const double share = double(back) / rays;
    return {share, std::sqrt(share * (1 - share) / rays)};
}

}  // namespace

TEST_CASE("photons at a smooth boundary follow Duntley's diffuse reflectances", "[bench][tracer]") {
    const support::ReferenceTable table("interface/diffuse_fresnel.csv");
    for (std::size_t row = 0; row < table.size(); ++row) {
        const TracedBoundary boundary{table.number(row, "n"), 0};
        CAPTURE(boundary.index);
        const Share outside = diffuse_reflectance(boundary, true, 100000);
        const Share inside = diffuse_reflectance(boundary, false, 100000);
        CHECK(std::abs(outside.value - table.number(row, "r_ext")) <=
              kStandardErrors * outside.standard_error);
        CHECK(std::abs(inside.value - table.number(row, "r_int")) <=
              kStandardErrors * inside.standard_error);
    }
}

TEST_CASE("photons at a rough boundary follow another program's random walk", "[bench][tracer]") {
    // rough_multiple_bounce.txt: GGX, n = 1.5, standard deviation .00078.
    struct Case {
        double alpha, inside;
    };
    const Case c =
        GENERATE(Case{0.1, 0.59174}, Case{0.2, 0.58694}, Case{0.3, 0.58095}, Case{0.5, 0.57437});
    const TracedBoundary boundary{1.5, c.alpha};
    const Share inside = diffuse_reflectance(boundary, false, 200000);
    const Share outside = diffuse_reflectance(boundary, true, 200000);
    CAPTURE(c.alpha, inside.value, outside.value);
    CHECK(std::abs(inside.value - c.inside) <=
          kStandardErrors * std::hypot(0.00078, inside.standard_error));
    // Equilibrium: n^2 (1 - r_int) = 1 - r_ext.
    CHECK(std::abs(2.25 * (1 - inside.value) - (1 - outside.value)) <=
          kStandardErrors * std::hypot(2.25 * inside.standard_error, outside.standard_error));
}

TEST_CASE("photons in a clear varnish follow Saunderson's correction", "[bench][tracer]") {
    const support::ReferenceTable table("interface/saunderson.csv");
    for (std::size_t row = 0; row < table.size(); ++row) {
        bench::TracedStack stack;
        stack.boundary.index = 1.5;
        stack.ground_albedo = table.number(row, "A");
        const auto traced = bench::trace_photons(stack, 1.0, {}, {.photons = 20000});
        const double truth = table.number(row, "saunderson");
        CAPTURE(*stack.ground_albedo, truth, traced.plane_albedo.value);
        CHECK(traced.plane_albedo.agrees_with(truth, kStandardErrors, 1e-12));
    }
}

TEST_CASE("photons in binders follow another program's", "[bench][tracer]") {
    const support::ReferenceTable table("interface/monte_carlo_half_space.csv");
    int compared = 0;
    for (std::size_t row = 0; row < table.size(); ++row) {
        if (table.number(row, "albedo") != 0.9) continue;
        bench::TracedStack stack;
        stack.boundary.index = 1.5;
        stack.base = {0.9, ScatteringLaw::henyey_greenstein(table.number(row, "g")), 0};
        std::vector<bench::Detector> detectors;
        const double mu_out = table.number(row, "mu_out");
        if (mu_out > 0) detectors.push_back({mu_out, table.number(row, "azimuth_deg")});
        const auto traced =
            bench::trace_photons(stack, table.number(row, "mu_in"), detectors, {.photons = 20000});
        const auto& mine = detectors.empty() ? traced.plane_albedo : traced.reflection[0];
        CAPTURE(row, mine.value, mine.standard_error, table.number(row, "value"));
        CHECK(std::abs(mine.value - table.number(row, "value")) <=
              kStandardErrors * std::hypot(mine.standard_error, table.number(row, "sigma")));
        ++compared;
    }
    CHECK(compared >= 8);
}

TEST_CASE("a tracer of boundaries says what it cannot do", "[bench][tracer][errors]") {
    bench::TracedStack stack;
    stack.boundary = {1.5, 0.2};
    CHECK_THROWS_WITH(bench::trace_photons(stack, 1.0, {{0.5, 0}}), Catch::Contains("detectors"));
    stack.boundary = {0.9, 0};
    CHECK_THROWS_WITH(bench::trace_photons(stack, 1.0, {}), Catch::Contains("[1, inf)"));
}
