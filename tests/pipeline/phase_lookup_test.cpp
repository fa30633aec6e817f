#include "pipeline/phase_lookup.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/support/catch.h"

using namespace miebrdf;

TEST_CASE("the scattering angles of a request contain every combination once",
          "[pipeline][phase_lookup]") {
    const std::vector<double> mu = {0.5, 1.0};
    // (1, 1) scatters straight back whatever the azimuth; retro-reflection (phi = 180, equal
    // cosines) does too; phi = 0 with mu = 0.5 scatters by 60 degrees.
    const auto angles = scattering_angles_deg(mu, mu, {0.0, 180.0});
    REQUIRE(angles.size() == 3);
    CHECK(angles[0] == Approx(60).epsilon(1e-12));
    CHECK(angles[1] == Approx(120).epsilon(1e-12));
    CHECK(angles[2] == Approx(180).epsilon(1e-7));  // arc cosine near -1 keeps half the digits
}

TEST_CASE("a lookup returns the value at its angle and refuses others",
          "[pipeline][phase_lookup]") {
    const std::vector<double> mu = {1e-4, 0.1, 0.30000000000000004, 0.7, 1.0};
    const std::vector<double> azimuths = {0, 1e-3, 45, 90, 179.999, 180};
    const auto angles = scattering_angles_deg(mu, mu, azimuths);
    const PhaseLookup phase(angles, angles);  // P(Theta) = Theta
    for (const double in : mu) {
        for (const double out : mu) {
            for (const double azimuth : azimuths) {
                const double c = -in * out + std::sqrt((1 - in * in) * (1 - out * out)) *
                                                 std::cos(azimuth * std::numbers::pi / 180);
                const double theta =
                    std::acos(std::clamp(c, -1.0, 1.0)) * 180 / std::numbers::pi;
                CHECK(std::abs(phase(c) - theta) <= PhaseLookup::kMatch_deg);
            }
        }
    }
    CHECK_THROWS_AS(phase(0.123456), std::logic_error);
}
