#include "tests/rte/reference_cases.h"
#include "tests/support/catch.h"

using namespace miebrdf;
using support::largest_relative_error;
using support::reflection_cases;

namespace {

// Far below what is asked, so that orders, not the tolerance, end the sum.
rte::SolverOptions exact_with(int streams) { return {.tolerance = 1e-13, .streams = streams}; }

}  // namespace

TEST_CASE("isotropic and Rayleigh half-spaces agree with the outside tables to 1e-12",
          "[rte][reference]") {
    const std::string file = GENERATE("R_halfspace_isotropic.csv", "R_halfspace_rayleigh.csv");
    for (const auto& reference : reflection_cases(file)) {
        CAPTURE(reference.name);
        // The tables carry 15 digits and were computed with 48 mapped nodes in long double.
        CHECK(largest_relative_error(reference, exact_with(32)) <= 1e-12);
    }
}

TEST_CASE("Henyey-Greenstein half-spaces agree with the outside table", "[rte][reference]") {
    for (const auto& reference : reflection_cases("R_halfspace_HG.csv")) {
        CAPTURE(reference.name);
        // Truncation of g^l by the grid; at g <= 0.75 and 64 nodes what is left is the table's own
        // deviation between its two discretisations (column dev_quad, up to 3e-11).
        const bool strong = reference.stack.base.chi[1] > 0.8;
        CHECK(largest_relative_error(reference, exact_with(64)) <= (strong ? 1e-4 : 1e-10));
    }
}

TEST_CASE("coated half-spaces agree with the outside table to 1e-9", "[rte][reference]") {
    for (const auto& reference : reflection_cases("R_coated_halfspace.csv")) {
        CAPTURE(reference.name);
        // The radiance has structure at mu ~ tau: 3e-10 for tau = 0.01, below 1e-12 for 0.1 and
        // more.
        CHECK(largest_relative_error(reference, exact_with(48)) <= 1e-9);
    }
}

TEST_CASE("grazing directions, thin and thick coats, hardly any absorption: 1e-9",
          "[rte][reference]") {
    for (const auto& reference : reflection_cases("R_stress_grazing_thin_conservative.csv")) {
        CAPTURE(reference.name);
        // mu = 1e-4: the table's dev_quad is 6e-10 there.
        CHECK(largest_relative_error(reference, exact_with(64)) <= 2e-9);
    }
}
