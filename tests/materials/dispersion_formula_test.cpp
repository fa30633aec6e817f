#include "materials/index/series.h"

#include <cmath>
#include <stdexcept>
#include <vector>

#include "tests/support/catch.h"

using namespace miebrdf::materials;

namespace {
constexpr double sodium_d_um = 0.5892938;
constexpr double helium_d_um = 0.5875618;
}  // namespace

TEST_CASE("dispersion formulas give the published indices", "[materials][formula]") {
    // Coefficients and indices as published; the bound is half a unit of the last printed digit.
    // Malitson 1965, table: fused silica, 20 C.
    const std::vector<double> silica{0,         0.6961663, 0.0684043, 0.4079426,
                                     0.1162414, 0.8974794, 9.896161};
    CHECK(std::abs(dispersion_formula(1, silica, helium_d_um) - 1.45846) <= 5e-6);
    CHECK(std::abs(dispersion_formula(1, silica, 0.4861327) - 1.46313) <= 5e-6);
    CHECK(std::abs(dispersion_formula(1, silica, 0.6562725) - 1.45637) <= 5e-6);
    // SCHOTT N-BK7 data sheet: nd = 1.51680, nF = 1.52238, nC = 1.51432.
    const std::vector<double> bk7{0,          1.03961212, 0.00600069867, 0.231792344, 0.0200179144,
                                  1.01046945, 103.560653};
    CHECK(std::abs(dispersion_formula(2, bk7, helium_d_um) - 1.51680) <= 5e-6);
    CHECK(std::abs(dispersion_formula(2, bk7, 0.4861327) - 1.52238) <= 5e-6);
    // Devore 1951, rutile, ordinary ray at the sodium lines: 2.6131 (measured; the fit is printed
    // to 4 digits of its coefficients, which leaves 5e-4).
    const std::vector<double> rutile{5.913, 0.2441, 0, 0.0803, 1, 0, 0, 0, 1};
    CHECK(std::abs(dispersion_formula(4, rutile, sodium_d_um) - 2.613) <= 5e-4);
    // Mansfield & Peck 1969, helium: (n - 1) 1e8 = 3488.3 at 632.99 nm.
    const std::vector<double> helium{0, 0.01470091, 423.98};
    CHECK(std::abs((dispersion_formula(6, helium, 0.63299) - 1) * 1e8 - 3488.3) <= 1.0);
}

TEST_CASE("formulas that share a curve agree with each other", "[materials][formula]") {
    // One Sellmeier term is written in the forms 1, 2, 4 and 9: n^2 = 1 + B + B C / (L^2 - C).
    const double B = 1.2, C = 0.01, L = 0.6;
    const double n = std::sqrt(1 + B * L * L / (L * L - C));
    const double rounding = 1e-14;
    CHECK(std::abs(dispersion_formula(1, std::vector{0.0, B, std::sqrt(C)}, L) - n) <= rounding);
    CHECK(std::abs(dispersion_formula(2, std::vector{0.0, B, C}, L) - n) <= rounding);
    CHECK(std::abs(dispersion_formula(4, std::vector{1.0, B, 2.0, C, 1.0}, L) - n) <= rounding);
    CHECK(std::abs(dispersion_formula(9, std::vector{1 + B, B * C, C}, L) - n) <= rounding);
    // Polynomials: 3 is the square of 5 for a single power.
    CHECK(std::abs(dispersion_formula(5, std::vector{1.5, 0.01, -2.0}, L) -
                   (1.5 + 0.01 / (L * L))) <= rounding);
    CHECK(std::abs(dispersion_formula(3, std::vector{2.25, 0.03, -2.0, 1e-4, -4.0}, L) -
                   std::hypot(std::hypot(1.5, std::sqrt(0.03) / L), 0.01 / (L * L))) <= rounding);
    // Herzberger with its poles only, by hand: L^2 - 0.028 = 0.332.
    CHECK(std::abs(dispersion_formula(7, std::vector{3.4, 0.1, 0.02, 1e-3}, L) -
                   (3.4 + 0.1 / 0.332 + 0.02 / (0.332 * 0.332) + 0.36e-3)) <= rounding);
    // Retro: (n^2 - 1) / (n^2 + 2) must come back.
    const double m = dispersion_formula(8, std::vector{0.3, 0.05, 0.02, 1e-3}, L);
    CHECK(std::abs((m * m - 1) / (m * m + 2) - (0.3 + 0.05 * 0.36 / 0.34 + 0.36e-3)) <= rounding);
    // Exotic with its second term only.
    CHECK(std::abs(dispersion_formula(9, std::vector{2.0, 0.0, 0.0, 0.1, 0.4, 0.04}, L) -
                   std::sqrt(2.0 + 0.1 * 0.2 / 0.08)) <= rounding);
}

TEST_CASE("terms with numerator 0 are left out, imaginary indices are no numbers",
          "[materials][formula]") {
    // 0 L^0 / (L^2 - 0^0) at L = 1 um would be 0/0.
    CHECK(dispersion_formula(4, std::vector{4.0, 0.0, 0.0, 0.0, 0.0}, 1.0) == 2.0);
    CHECK(std::isnan(dispersion_formula(3, std::vector{-1.0}, 1.0)));
    CHECK(std::isnan(dispersion_formula(2, std::vector{0.0, 1.0, 1.0}, 1.0)));  // on the pole
    CHECK_THROWS_WITH(dispersion_formula(10, std::vector{1.0}, 1.0), Catch::Contains("10"));
}
