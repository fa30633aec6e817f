#include <miebrdf/sphere.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "mie/sphere/radial_functions.h"
#include "mie/sphere/sphere_block.h"
#include "tests/support/catch.h"
#include "tests/support/reference_table.h"

using namespace miebrdf;
using Complex = std::complex<double>;

namespace {

double relative(double value, double truth) {
    return truth == 0 ? std::abs(value) : std::abs(value / truth - 1);
}

}  // namespace

TEST_CASE("one sphere agrees with the 60-digit table on every row", "[mie][sphere]") {
    const support::ReferenceTable table("mie/single_sphere.csv");
    REQUIRE(table.size() == 52);
    for (std::size_t row = 0; row < table.size(); ++row) {
        const Complex m(table.number(row, "nr"), table.number(row, "k"));
        const double x = table.number(row, "x");
        const auto sphere = mie::scatter_by_sphere(m, x);
        CAPTURE(m, x, sphere.accuracy);
        // m = 1 + 1e-7: a_n hangs on m^2 - 1, which a double m only holds to 2e-9.
        const bool near_one = std::abs(m - 1.0) < 1e-3;
        const double bound = near_one ? 1e-8 : 1e-12;
        CHECK(relative(sphere.q_ext, table.number(row, "Qext")) <= bound);
        CHECK(relative(sphere.q_sca, table.number(row, "Qsca")) <= bound);
        CHECK(relative(sphere.q_abs, table.number(row, "Qabs")) <= bound);
        CHECK(relative(sphere.asymmetry, table.number(row, "g")) <= (near_one ? 2e-8 : 1e-11));
        CHECK(sphere.reached == !near_one);
        // Backscattering is an alternating sum: x terms of rounding each, and m x is rounded, so
        // that the phase of the wave inside errs by up to 3e-15 x.
        if (!near_one)
            CHECK(relative(sphere.q_back, table.number(row, "Qback")) <= 1e-12 + 4e-15 * x);
    }
}

TEST_CASE("orders in vectors are those that mie_coefficients forms one by one", "[mie][sphere]") {
    // Both go their own ways to psi and eta; mie_coefficients divides by them, and rounds m x: by
    // 1e-16 |m| x of a phase, and more where a resonance is narrower.
    const Complex m = GENERATE(
        Complex(1.5, 0), Complex(60, 0.5),                    // upward, damped
        Complex(1.05, 0), Complex(0.6, 0), Complex(0.02, 0),  // downward, out of range otherwise
        Complex(1.33, 1e-7), Complex(1.02, 1e-7),             // absorption summed both ways
        Complex(0.6, 1e-4), Complex(0.5, 1e-4),               // hidden by total reflection
        Complex(1.5, 0.02), Complex(2.6, 0.02), Complex(0.2, 3.4), Complex(1.5, 1000));
    // Whole vectors, and one order more; starts by WKB.
    const double x = GENERATE(64.0, 71.99, 72.0, 503.0, 3000.0, 3e4);
    const auto waves = mie::mie_coefficients(m, x);
    double scattered = 0, absorbed = 0, asymmetric = 0;
    Complex back = 0;
    for (std::size_t i = 0; i < waves.a.size(); ++i) {
        const double n = i + 1.0;
        const Complex a = waves.a[i], b = waves.b[i];
        scattered += (2 * n + 1) * (std::norm(a) + std::norm(b));
        absorbed += (2 * n + 1) * waves.absorbed[i];
        asymmetric += (2 * n + 1) / (n * (n + 1)) * (a * std::conj(b)).real();
        if (i > 0) {
            asymmetric += (n - 1) * (n + 1) / n *
                          (a * std::conj(waves.a[i - 1]) + b * std::conj(waves.b[i - 1])).real();
        }
        back += (2 * n + 1) * (i % 2 ? 1 : -1) * (a - b);
    }
    const auto sphere = mie::scatter_by_sphere(m, x);
    CAPTURE(m, x);
    const double phase = 1e-16 * std::abs(m) * x;
    CHECK(relative(sphere.q_sca, 2 * scattered / x / x) <= 1e-13 + phase);
    CHECK(relative(sphere.q_abs, 2 * absorbed / x / x) <= 1e-13 + 10 * phase);
    CHECK(std::abs(sphere.asymmetry - 2 * asymmetric / scattered) <= 1e-13 + phase);
    CHECK(std::abs(sphere.q_back - std::norm(back / x)) <=
          (1e-12 + 10 * phase) * x * sphere.q_back);
    CHECK(sphere.terms == static_cast<int>(waves.a.size()));
}

TEST_CASE("the wave inside a damped sphere has all its digits wherever it is known in closed form",
          "[mie][sphere]") {
    using Exact = std::complex<long double>;
    // The recurrence downward from far above, where any start is forgotten.
    const auto exact = [](Complex z, int order) {
        const Exact inverse = Exact(1) / Exact(z.real(), z.imag());
        Exact D = 0;
        for (int n = mie::safe_start(std::abs(z), order) + 60; n > order; --n) {
            const Exact step = static_cast<long double>(n) * inverse;
            D = step - Exact(1) / (D + step);
        }
        return Complex(D);
    };
    std::mt19937 random(7);
    std::uniform_real_distribution<double> share(0, 1);
    int known = 0;
    const auto check = [&](Complex z, int order) {
        const auto D = mie::damped_logarithmic_derivative(z, order);
        if (!D) return;
        ++known;
        CAPTURE(z, order);
        // Rounding of its terms, and the wave from the far side: exp(-36).
        CHECK(std::abs(*D / exact(z, order) - 1.0) <= 1e-15);
    };
    for (int i = 0; i < 1000; ++i) {
        const double modulus = 50 * std::pow(200.0, share(random));
        const double damping = std::min(modulus, 15 + 30 * share(random) / share(random));
        const Complex z(std::sqrt(modulus * modulus - damping * damping), damping);
        check(z, static_cast<int>(share(random) * modulus / 1.3));
    }
    CHECK(known >= 300);
    // Where the order is near |z|, less of the damping counts than Im z says.
    check({1e6, 20.5}, 750000);
    // x = 1000, k = 0.02.
    known = 0;
    check({2600, 20}, 1092);
    CHECK(known == 1);
}

TEST_CASE("small spheres follow Rayleigh's law with its first correction", "[mie][sphere]") {
    // Bohren & Huffman 1983, eq. (5.4): Q_sca = 8/3 x^4 |L|^2 (1 + 6/5 Re((m^2 - 2)/(m^2 + 2)) x^2
    // + ...), L = (m^2 - 1)/(m^2 + 2), for k = 0; the next order is x^3 for k > 0, x^4 for k = 0.
    const double x = GENERATE(1e-20, 1e-12, 1e-8, 1e-5, 1e-3);
    const double m = GENERATE(0.3, 1.1, 1.5, 4.0);
    const double L = (m * m - 1) / (m * m + 2);
    const double leading = 8.0 / 3 * std::pow(x, 4) * L * L;
    const double correction = 1 + 1.2 * (m * m - 2) / (m * m + 2) * x * x;
    const auto sphere = mie::scatter_by_sphere(m, x);
    CAPTURE(m, x);
    CHECK(relative(sphere.q_sca, leading * correction) <= 1e-14 + 20 * std::pow(x, 4));
    CHECK(relative(sphere.q_back, 1.5 * leading) <= 1e-14 + 20 * x * x);
    CHECK(std::abs(sphere.asymmetry) <= 5 * x * x);
}

TEST_CASE("small absorbing spheres absorb as x Im L", "[mie][sphere]") {
    const double x = GENERATE(1e-15, 1e-8, 1e-6);
    const Complex m =
        GENERATE(Complex(1.5, 1e-9), Complex(1.5, 0.1), Complex(0.05, 3), Complex(3, 4));
    const Complex L = (m * m - 1.0) / (m * m + 2.0);
    CAPTURE(m, x);
    // Next order: x^2. The bound on rounding covers the resonance denominator m^2 + 2.
    CHECK(relative(mie::scatter_by_sphere(m, x).q_abs, 4 * x * L.imag()) <= 1e-13 + 100 * x * x);
}

TEST_CASE("extinction obeys the optical theorem", "[mie][sphere][amplitudes]") {
    const Complex m = GENERATE(Complex(1.33, 0), Complex(2.6, 0), Complex(1.5, 1e-6),
                               Complex(3.3, 0.02), Complex(0.2, 3), Complex(0.7, 0));
    const double x = GENERATE(0.01, 0.7, 12.0, 300.0, 5000.0);
    const double forward = 0;
    const auto amplitudes = mie::scattering_amplitudes(m, x, {&forward, 1});
    CAPTURE(m, x);
    // Q_ext = 4/x^2 Re S(0). In Re a_n small spheres lose what Im a_n has more: x^3 per unit.
    const double rounding = 1e-13 + (x < 1 ? 1e-15 / (x * x * x) * (m.imag() > 0) : 0.0);
    CHECK(relative(4 * amplitudes.s1[0].real() / x / x, mie::scatter_by_sphere(m, x).q_ext) <=
          rounding);
}

TEST_CASE("absorption is the difference of extinction and scattering, but without its loss",
          "[mie][sphere]") {
    SECTION("k = 0 absorbs exactly nothing") {
        const double x = GENERATE(1e-8, 0.3, 3.0, 100.0, 1e5);
        CHECK(mie::scatter_by_sphere(1.5, x).q_abs == 0);
    }
    SECTION("weak absorption is linear in k down to 1e-14") {
        // Q_abs = k dQ_abs/dk + O(k^2): the ratio at k and 1e-3 k is the same to first order. Off
        // the narrow resonances that k = 1e-9 could already damp: x = 3.
        const double strong = mie::scatter_by_sphere({1.5, 1e-11}, 3).q_abs;
        const double weak = mie::scatter_by_sphere({1.5, 1e-14}, 3).q_abs;
        CHECK(relative(strong, 1000 * weak) <= 1e-9);
    }
    SECTION("and on down to the smallest number") {
        // Near it terms of sums have no digits: k = 1e-320 absorbed less than nothing.
        const double n = GENERATE(0.05, 0.9, 1.02, 1.5, 2.5);
        const double x = GENERATE(0.4, 3.0, 10.0, 200.0, 3000.0);
        const double known = mie::scatter_by_sphere({n, 1e-150}, x).q_abs / 1e-150;
        CAPTURE(n, x);
        const double smallest = std::numeric_limits<double>::denorm_min();
        for (const double k : {1e-200, 1e-308, 1e-320, smallest}) {
            const double absorbed = k * known;
            const double rounding = 1e-13 * absorbed + smallest;
            CAPTURE(k);
            const double q_abs = mie::scatter_by_sphere({n, k}, x).q_abs;
            CHECK(q_abs >= 0);
            CHECK(std::abs(q_abs - absorbed) <= rounding);
            const std::vector<double> sizes = {x}, weights = {2 / x / x};
            const auto sums = mie::compute_spheres(Complex(n, k), sizes, weights, nullptr);
            CHECK(sums.absorbed >= 0);
            CHECK(std::abs(sums.absorbed - absorbed) <= rounding + 1e-11 * absorbed);
        }
    }
    SECTION("strong absorption equals the difference") {
        const auto sphere = mie::scatter_by_sphere({1.5, 0.5}, 20);
        const double forward = 0;
        const auto s = mie::scattering_amplitudes({1.5, 0.5}, 20, {&forward, 1});
        CHECK(sphere.q_abs == Approx(4 * s.s1[0].real() / 400 - sphere.q_sca).epsilon(1e-12));
    }
}

TEST_CASE("a huge opaque sphere reflects as Fresnel says and doubles its shadow", "[mie][sphere]") {
    // Geometric optics of an opaque sphere: Q_ext -> 2, Q_back -> |(m - 1)/(m + 1)|^2, with
    // corrections of order x^(-2/3) for edge rays and 1/x^2 for the axis.
    const Complex m(1.5, 1);
    const auto sphere = mie::scatter_by_sphere(m, 1e5);
    CHECK(relative(sphere.q_ext, 2) <= 2 * std::pow(1e5, -2.0 / 3));
    CHECK(relative(sphere.q_back, std::norm((m - 1.0) / (m + 1.0))) <= 1e-4);
}

TEST_CASE("no argument in the plane gives a NaN or breaks a bound", "[mie][sphere][stress]") {
    const double n = GENERATE(0.05, 0.5, 0.999, 1.0001, 1.5, 10.0);
    const double k = GENERATE(0.0, 1e-12, 1e-3, 1.0, 30.0, 1000.0);
    for (const double x : {1e-8, 1e-3, 0.09, 0.49, 0.51, 1.9, 17.0, 400.0, 2e4}) {
        const auto sphere = mie::scatter_by_sphere({n, k}, x);
        CAPTURE(n, k, x);
        CHECK(sphere.q_sca > 0);
        CHECK(sphere.q_abs >= 0);
        CHECK(sphere.q_back >= 0);
        CHECK(sphere.q_ext <= 10 + 6 / x / x);  // resonances: 2 (2n+1)/x^2 per wave at most
        CHECK(std::abs(sphere.asymmetry) <= 1);
    }
}

TEST_CASE("a sphere of the index of its host scatters nothing at all", "[mie][sphere]") {
    const double x = GENERATE(1e-3, 1.0, 300.0);
    const mie::SphereLayer alike[] = {{1.0, 0.5 * x}, {1.0, x}};
    for (const auto& optics : {mie::scatter_by_sphere(1.0, x), mie::scatter_by_sphere(alike)}) {
        CHECK(optics.q_ext == 0);
        CHECK(optics.q_sca == 0);
        CHECK(optics.q_abs == 0);
        CHECK(optics.q_back == 0);
        CHECK(optics.reached);
    }
}

TEST_CASE("a sphere refuses nonsense with the value in the message", "[mie][sphere][errors]") {
    CHECK_THROWS_WITH(mie::scatter_by_sphere({1.5, -0.1}, 1), Catch::Contains("-0.1"));
    CHECK_THROWS_WITH(mie::scatter_by_sphere({0, 0}, 1), Catch::Contains("[0.01, 100]"));
    CHECK_THROWS_WITH(mie::scatter_by_sphere({1.5, std::nan("")}, 1), Catch::Contains("nan"));
    CHECK_THROWS_WITH(mie::scatter_by_sphere(1.5, 0), Catch::Contains("1e-30"));
    CHECK_THROWS_WITH(mie::scatter_by_sphere(1.5, -3), Catch::Contains("-3"));
    CHECK_THROWS_WITH(mie::scatter_by_sphere(1.5, INFINITY), Catch::Contains("inf"));
}
