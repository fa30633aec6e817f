#include "pipeline/exports/phase_table.h"

#include <cmath>

#include "tests/support/catch.h"

using miebrdf::exports::phase_table_angles_deg;
using miebrdf::exports::PhaseTable;

TEST_CASE("phase table angles ascend from 0 to 180 degrees", "[exports][phase_table]") {
    const auto angles = phase_table_angles_deg();
    CHECK(angles.front() == 0.0);
    CHECK(angles.back() == 180.0);
    for (std::size_t i = 1; i < angles.size(); ++i) CHECK(angles[i] > angles[i - 1]);
}

TEST_CASE("phase table follows a peaked Henyey-Greenstein function between its angles",
          "[exports][phase_table]") {
    const double g = 0.9;
    const auto phase = [g](double c) { return (1 - g * g) / std::pow(1 + g * g - 2 * g * c, 1.5); };
    const PhaseTable table(phase_table_angles_deg(), phase);
    for (double angle = 0.013; angle < 180; angle += 1.37) {
        const double c = std::cos(angle * M_PI / 180);
        CAPTURE(angle);
        // Cubic on steps of 0.5 degrees of a peak 6 degrees wide; PCHIP's slopes are second order.
        CHECK(std::abs(table(c) / phase(c) - 1) <= 5e-4);
    }
    CHECK(table.error_estimate() <= 2e-3);
    CHECK(table.error_estimate() > 0);
}
