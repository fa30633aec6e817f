// The fast part of the stress battery; `miebrdf stress` runs all of it.
#include "tools/stress/battery.h"

#include <cmath>
#include <stdexcept>

#include "tests/support/catch.h"

using namespace miebrdf;

namespace {

// Every check of a suite must hold; the ones that do not are shown with their cause.
void require_all(stress::SuiteFunction* suite, std::size_t at_least) {
    std::vector<stress::Check> checks;
    stress::Log log("suite", checks);
    suite(log, true);
    CHECK(checks.size() >= at_least);
    for (const auto& c : checks) {
        if (c.ok()) continue;
        CAPTURE(c.test_case, c.quantity, c.value, c.bound, c.cause);
        CHECK(c.value <= c.bound);
    }
}

}  // namespace

TEST_CASE("stress: spheres", "[stress]") { require_all(stress::spheres, 200); }
TEST_CASE("stress: ensembles", "[stress]") { require_all(stress::ensembles, 100); }
TEST_CASE("stress: half-spaces", "[stress]") { require_all(stress::half_spaces, 200); }
TEST_CASE("stress: coats", "[stress]") { require_all(stress::coats, 80); }
TEST_CASE("stress: boundaries", "[stress]") { require_all(stress::boundaries, 280); }
TEST_CASE("stress: surfaces", "[stress]") { require_all(stress::surfaces, 80); }
TEST_CASE("stress: materials", "[stress]") { require_all(stress::materials, 30); }
TEST_CASE("stress: sphere switches", "[stress]") { require_all(stress::sphere_switches, 150); }
TEST_CASE("stress: transfer switches", "[stress]") { require_all(stress::transfer_switches, 20); }
TEST_CASE("stress: photons", "[stress]") { require_all(stress::photons, 30); }
TEST_CASE("stress: promises", "[stress]") { require_all(stress::promises, 24); }

TEST_CASE("the battery notices what is broken", "[stress]") {
    std::vector<stress::Check> checks;
    stress::Log log("test", checks);
    log.run("nan", [](const stress::Case& is) { is.at_most("q", std::nan(""), 1, ""); });
    log.run("large", [](const stress::Case& is) { is.at_most("q", 2, 1, ""); });
    log.refused("accepted", [] {});
    log.run("threw", [](const stress::Case&) { throw std::runtime_error("no"); });
    REQUIRE(checks.size() == 4);
    for (const auto& c : checks) CHECK_FALSE(c.ok());
    log.run("small", [](const stress::Case& is) { is.at_most("q", 1, 1, ""); });
    log.refused("refused", [] { throw std::invalid_argument("no"); });
    CHECK(checks[4].ok());
    CHECK(checks[5].ok());
    CHECK_THAT(stress::tally(checks), Catch::Contains("| test | 6 | 4 |"));
}
