#include <miebrdf/sphere.h>

#include <fmt/format.h>

#include <array>
#include <cmath>

#include "tests/support/catch.h"
#include "tests/support/reference_table.h"

using namespace miebrdf;
using Complex = std::complex<double>;

TEST_CASE("amplitudes agree with the 60-digit table up to x = 10,000", "[mie][amplitudes]") {
    const support::ReferenceTable table("mie/single_sphere.csv");
    const std::array<double, 7> angles = {0, 30, 60, 90, 120, 150, 180};
    for (std::size_t row = 0; row < table.size(); ++row) {
        const Complex m(table.number(row, "nr"), table.number(row, "k"));
        const double x = table.number(row, "x");
        if (std::abs(m - 1.0) < 1e-3) continue;  // conditioning: docs/maths-mie.md
        const auto amplitudes = mie::scattering_amplitudes(m, x, angles);
        for (std::size_t i = 0; i < angles.size(); ++i) {
            // The table's time factor is exp(+i omega t): complex conjugate.
            const auto entry = [&](int which) {
                return Complex(table.number(row, fmt::format("S{}_re_{}", which, angles[i])),
                               -table.number(row, fmt::format("S{}_im_{}", which, angles[i])));
            };
            CAPTURE(m, x, angles[i]);
            const double bound = x <= 1e4 ? 1e-9 : 1e-8;  // rounding grows with the number of terms
            CHECK(std::abs(amplitudes.s1[i] - entry(1)) <= bound * std::abs(entry(1)));
            CHECK(std::abs(amplitudes.s2[i] - entry(2)) <= bound * std::abs(entry(2)));
        }
    }
}

TEST_CASE("both amplitudes agree forward and are opposite backward", "[mie][amplitudes]") {
    const Complex m = GENERATE(Complex(1.33, 0), Complex(2.6, 0.1));
    const double x = GENERATE(1e-6, 5.0, 300.0);
    const std::array<double, 2> ends = {0, 180};
    const auto s = mie::scattering_amplitudes(m, x, ends);
    CHECK(std::abs(s.s1[0] - s.s2[0]) <= 1e-13 * std::abs(s.s1[0]));
    CHECK(std::abs(s.s1[1] + s.s2[1]) <= 1e-11 * std::abs(s.s1[1]));
}

TEST_CASE("amplitudes refuse angles outside 0 to 180 degrees", "[mie][amplitudes][errors]") {
    const double angle = GENERATE(-1.0, 180.1);
    CHECK_THROWS_WITH(mie::scattering_amplitudes(1.5, 1, {&angle, 1}),
                      Catch::Contains(fmt::format("{}", angle)) && Catch::Contains("0 to 180"));
}
