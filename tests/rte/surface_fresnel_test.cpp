#include <cmath>
#include <complex>
#include <limits>

#include "rte/surface/fresnel.h"
#include "tests/support/catch.h"

using namespace miebrdf;
using Complex = std::complex<double>;

namespace {

/// The textbook form in long double, with Snell's law for the angle inside: owes nothing to the
/// rearranged form under test (Born & Wolf 1999, section 1.5.2, eq. 21a).
double textbook(Complex index, double cos_incidence) {
    using Wide = std::complex<long double>;
    const Wide m(index.real(), index.imag());
    const long double c = cos_incidence;
    const Wide inside = std::sqrt(Wide(1) - (1 - c * c) / (m * m));
    const Wide s = (c - m * inside) / (c + m * inside);
    const Wide p = (m * c - inside) / (m * c + inside);
    return static_cast<double>((std::norm(s) + std::norm(p)) / 2);
}

}  // namespace

TEST_CASE("Fresnel reflectance at normal incidence is |m - 1|^2 / |m + 1|^2", "[rte][fresnel]") {
    const Complex m =
        GENERATE(Complex(1.5, 0), Complex(0.05, 0), Complex(0.27, 2.95), Complex(80, 40));
    const double closed_form = std::norm(m - 1.0) / std::norm(m + 1.0);
    CHECK(rte::fresnel_reflectance(m, 1.0) == Approx(closed_form).epsilon(1e-14));  // rounding
    CHECK(rte::normal_reflectance(m) == Approx(closed_form).epsilon(1e-14));
}

TEST_CASE("at Brewster's angle only one polarisation is reflected", "[rte][fresnel]") {
    // tan(theta) = n: r_p = 0 and r_s = (1 - n^2) / (1 + n^2), Born & Wolf 1999, section 1.5.3.
    const double n = GENERATE(1.0001, 1.33, 1.5, 2.6, 10.0, 0.7);
    const double r_s = (1 - n * n) / (1 + n * n);
    const double brewster_cos = 1 / std::sqrt(1 + n * n);
    // r_p vanishes quadratically, so rounding of the angle does not show.
    CHECK(rte::fresnel_reflectance(n, brewster_cos) == Approx(0.5 * r_s * r_s).epsilon(1e-11));
}

TEST_CASE("Fresnel reflectance agrees with Snell's law and the textbook amplitudes",
          "[rte][fresnel]") {
    const Complex m =
        GENERATE(Complex(1.33, 0), Complex(2.6, 0.01), Complex(0.056, 4.28),  // Ag, 650 nm
                 Complex(0.93, 6.33), Complex(4.2, 0.5), Complex(0.8, 0.3));
    for (double c = 0; c <= 1.0; c += 1.0 / 64) {
        CAPTURE(m, c);
        // Rounding of about ten operations.
        CHECK(std::abs(rte::fresnel_reflectance(m, c) - textbook(m, c)) <= 4e-15);
    }
}

TEST_CASE("below the critical angle of a thinner medium everything is reflected",
          "[rte][fresnel]") {
    const double n = 1 / 1.5;
    const double critical_cos = std::sqrt(1 - n * n);
    CHECK(rte::fresnel_reflectance(n, critical_cos * 0.999) == Approx(1.0).epsilon(1e-14));
    CHECK(rte::fresnel_reflectance(n, critical_cos * 0.1) == Approx(1.0).epsilon(1e-14));
    CHECK(rte::fresnel_reflectance(n, critical_cos * 1.01) < 0.7);
}

TEST_CASE("a boundary without contrast reflects nothing and a weak one keeps its digits",
          "[rte][fresnel]") {
    for (const double c : {0.0, 1e-300, 1e-8, 0.3, 1.0})
        CHECK(rte::fresnel_reflectance(1.0, c) == 0.0);
    // First order in m - 1 = d at 45 degrees: r_s = -d / (2 c^2) = -d, r_p = r_s^2 = d^2.
    const double d = std::ldexp(1.0, -30);  // 1 + d is exact
    CHECK(rte::fresnel_reflectance(1 + d, std::sqrt(0.5)) == Approx(0.5 * d * d).epsilon(1e-8));
}

TEST_CASE("every boundary with contrast is a mirror at grazing", "[rte][fresnel]") {
    const Complex m =
        GENERATE(Complex(1.5, 0), Complex(1.5, 1e-9), Complex(0.2, 3), Complex(1000, 0));
    CHECK(rte::fresnel_reflectance(m, 0.0) == Approx(1.0).epsilon(1e-14));
    // 1 - R = 2 c Re((1 + m^2) / sqrt(m^2 - 1) + ...): linear in c, no jump.
    const double at_1e8 = 1 - rte::fresnel_reflectance(m, 1e-8);
    const double at_2e8 = 1 - rte::fresnel_reflectance(m, 2e-8);
    // 1e-15 / 1e-8 rounding of 1 - R; curvature: 1e-8 |m|^2.
    CHECK(at_2e8 / at_1e8 == Approx(2.0).epsilon(0.03));
}

TEST_CASE("Schlick's formula is exact at both ends", "[rte][fresnel]") {
    const Complex m(2.0, 0.7);
    const double f0 = rte::normal_reflectance(m);
    CHECK(rte::schlick_reflectance(f0, 1.0) == f0);
    CHECK(rte::schlick_reflectance(f0, 0.0) == 1.0);
    CHECK(rte::schlick_reflectance(f0, 0.5) == Approx(f0 + (1 - f0) / 32).epsilon(1e-15));
    const rte::FresnelReflectance schlick(m, rte::FresnelKind::schlick);
    CHECK(schlick(0.5) == rte::schlick_reflectance(f0, 0.5));
    const rte::FresnelReflectance exact(m, rte::FresnelKind::exact);
    CHECK(exact(0.5) == rte::fresnel_reflectance(m, 0.5));
}

TEST_CASE("a surface refuses indices that no material has", "[rte][fresnel][errors]") {
    const double inf = std::numeric_limits<double>::infinity();
    using rte::FresnelKind;
    CHECK_THROWS_WITH(rte::FresnelReflectance(Complex(0, 1), FresnelKind::exact),
                      Catch::Contains("0 + 1i"));
    CHECK_THROWS_WITH(rte::FresnelReflectance(Complex(1.5, -0.1), FresnelKind::exact),
                      Catch::Contains("-0.1") && Catch::Contains("k >= 0"));
    CHECK_THROWS_WITH(rte::FresnelReflectance(Complex(std::nan(""), 0), FresnelKind::schlick),
                      Catch::Contains("nan"));
    CHECK_THROWS(rte::FresnelReflectance(Complex(inf, 0), FresnelKind::exact));
}
