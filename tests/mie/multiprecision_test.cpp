// Truth from many digits: Mie's formulas as the textbook has them, with no care for stability but
// digits.
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <cmath>
#include <complex>
#include <random>
#include <vector>

#include <miebrdf/sphere.h>
#include "tests/support/catch.h"

using namespace miebrdf;
using Real = boost::multiprecision::number<boost::multiprecision::cpp_bin_float<500>,
                                           boost::multiprecision::et_off>;

namespace {

// A complex number with only what is needed here.
struct Complex {
    Real re = 0, im = 0;
};
Complex operator+(const Complex& a, const Complex& b) { return {a.re + b.re, a.im + b.im}; }
Complex operator-(const Complex& a, const Complex& b) { return {a.re - b.re, a.im - b.im}; }
Complex operator*(const Complex& a, const Complex& b) {
    return {a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re};
}
Complex operator*(const Real& a, const Complex& b) { return {a * b.re, a * b.im}; }
Complex operator/(const Complex& a, const Complex& b) {
    const Real norm = b.re * b.re + b.im * b.im;
    return {(a.re * b.re + a.im * b.im) / norm, (a.im * b.re - a.re * b.im) / norm};
}

struct Truth {
    double q_ext, q_sca, q_abs, asymmetry;
};

// psi_n(x) upward loses digits as eta_n grows, psi_n(mx) as exp(2 Im mx): 500 digits leave 100 for
// x from 1e-8 and Im mx up to 200.
Truth scatter_by_textbook(std::complex<double> index, double size_parameter, int terms) {
    const Real x = size_parameter;
    const Complex m{index.real(), index.imag()};
    const Complex z = x * m;
    const Real e = exp(z.im), sinh_y = (e - 1 / e) / 2, cosh_y = (e + 1 / e) / 2;
    Complex inside_before{sin(z.re) * cosh_y, cos(z.re) * sinh_y};  // psi_0(z)
    const Complex cosine{cos(z.re) * cosh_y, -sin(z.re) * sinh_y};  // psi_{-1}(z)
    Complex inside = inside_before / z - cosine;                    // psi_1(z)
    Complex outgoing_before{sin(x), -cos(x)};                       // xi_0 = psi_0 + i x y_0
    Complex outgoing = (1 / x) * outgoing_before - Complex{cos(x), sin(x)};
    Real scattered = 0, extinguished = 0, forward = 0;
    Complex a_before, b_before;
    for (int n = 1; n <= terms; ++n) {
        const Complex D = inside_before / inside - Real(n) * (Complex{1, 0} / z);
        const Complex A = D / m + Complex{n / x, 0}, B = D * m + Complex{n / x, 0};
        const Complex psi{outgoing.re, 0}, psi_before{outgoing_before.re, 0};
        const Complex a = (A * psi - psi_before) / (A * outgoing - outgoing_before);
        const Complex b = (B * psi - psi_before) / (B * outgoing - outgoing_before);
        const auto dot = [](const Complex& u, const Complex& v) -> Real {
            return u.re * v.re + u.im * v.im;
        };
        scattered += (2 * n + 1) * (dot(a, a) + dot(b, b));
        extinguished += (2 * n + 1) * (a.re + b.re);
        forward += Real(2 * n + 1) / (n * (n + 1)) * dot(a, b);
        if (n > 1) forward += Real((n - 1) * (n + 1)) / n * (dot(a, a_before) + dot(b, b_before));
        a_before = a;
        b_before = b;
        const Complex inside_next = Real(2 * n + 1) * (inside / z) - inside_before;
        inside_before = inside;
        inside = inside_next;
        const Complex outgoing_next = (Real(2 * n + 1) / x) * outgoing - outgoing_before;
        outgoing_before = outgoing;
        outgoing = outgoing_next;
    }
    const Real unit = 2 / (x * x);
    return {double(unit * extinguished), double(unit * scattered),
            double(unit * (extinguished - scattered)), double(2 * forward / scattered)};
}

}  // namespace

TEST_CASE("one sphere agrees with the textbook in 500 digits", "[mie][sphere][multiprecision]") {
    const std::complex<double> m = GENERATE(
        std::complex<double>(1.33, 0), std::complex<double>(1.33, 1e-8),
        std::complex<double>(2.6, 0), std::complex<double>(0.4, 0), std::complex<double>(0.05, 1.5),
        std::complex<double>(1.5, 1), std::complex<double>(8, 8));
    // Both sides of the switch of formulas at x = 0.5, and of number_of_terms at 0.001.
    const double x = GENERATE(1e-6, 0.0009, 0.0011, 0.03, 0.49, 0.51, 1.7, 9.3, 31.0);
    const int terms = static_cast<int>(x + 8 * std::cbrt(x) + 12);
    const Truth truth = scatter_by_textbook(m, x, terms);
    const auto sphere = mie::scatter_by_sphere(m, x);
    CAPTURE(m, x);
    CHECK(std::abs(sphere.q_ext / truth.q_ext - 1) <= 1e-12);
    CHECK(std::abs(sphere.q_sca / truth.q_sca - 1) <= 1e-12);
    CHECK(std::abs(sphere.asymmetry - truth.asymmetry) <=
          1e-11 * std::max(std::abs(truth.asymmetry), x * x));
    if (m.imag() == 0) {
        CHECK(sphere.q_abs == 0);
    } else {
        CHECK(std::abs(sphere.q_abs / truth.q_abs - 1) <= 1e-12);
    }
}

TEST_CASE("spheres anywhere in the plane agree with the textbook in 500 digits",
          "[mie][sphere][multiprecision]") {
    std::mt19937 generator(20130);
    std::uniform_real_distribution<double> uniform(0, 1);
    const auto between = [&](double low, double high) {  // uniform in the logarithm
        return low * std::pow(high / low, uniform(generator));
    };
    int reached = 0;
    for (int point = 0; point < 300; ++point) {
        const double x = between(1e-8, 120);
        const double most_k = std::min(1000.0, 200 / x);
        double n = between(0.05, 10);
        double k = point % 3 == 0 ? 0.0 : between(1e-9, most_k);
        if (point % 10 == 1) {  // close to the host
            n = 1 + between(1e-9, 1e-2);
            k = 0;
        }
        const std::complex<double> m(n, k);
        const int terms = static_cast<int>(x + 8 * std::cbrt(x) + 12);
        const Truth truth = scatter_by_textbook(m, x, terms);
        const auto sphere = mie::scatter_by_sphere(m, x);
        CAPTURE(point, m, x, sphere.accuracy, sphere.status);
        // What the status promises, and the documented 1e-12 where it promises everything.
        const double bound = sphere.reached ? 1e-12 : 5 * sphere.accuracy;
        CHECK(std::abs(sphere.q_ext / truth.q_ext - 1) <= bound);
        CHECK(std::abs(sphere.q_sca / truth.q_sca - 1) <= bound);
        CHECK(std::abs(sphere.q_abs - truth.q_abs) <= bound * truth.q_abs);
        CHECK(std::abs(sphere.asymmetry - truth.asymmetry) <= 10 * bound);
        reached += sphere.reached;
    }
    CHECK(reached >= 240);
}
