#include "mie/partial_waves.h"

#include <cmath>

#include "mie/coefficients.h"
#include "mie/lane_response.h"
#include "mie/logarithmic_derivative.h"
#include "mie/radial_functions.h"
#include "mie/terms.h"

namespace miebrdf::mie {
namespace {

using Complex = std::complex<double>;
using ConstLanes = Eigen::Map<const Lanes>;

constexpr double least_vector_size = 2;     // below, mie_coefficients has more care
constexpr double well_off_the_host = 1e-2;  // nearer, too

// psi_n(z), n = 0 ... terms, padded to whole vectors by ones.
struct InsideValues {
    std::vector<double> re, im;
};

InsideValues inside_values(Complex z, int terms, int padded) {
    InsideValues psi{std::vector<double>(padded, 1.0), std::vector<double>(padded, 0.0)};
    const Complex inverse = 1.0 / z;
    Complex before = std::cos(z), here = std::sin(z);
    psi.re[0] = here.real();
    psi.im[0] = here.imag();
    for (int n = 1; n <= terms; ++n) {
        const double f = (2 * n - 1) * inverse.real(), g = (2 * n - 1) * inverse.imag();
        const Complex next = {f * here.real() - g * here.imag() - before.real(),
                              f * here.imag() + g * here.real() - before.imag()};
        before = here;
        here = next;
        psi.re[n] = here.real();
        psi.im[n] = here.imag();
    }
    return psi;
}

// T_n = Im(psi_{n-1} conj psi_n), summed where that keeps digits (absorption_source.h).
std::vector<double> absorption_sources(Complex z, const InsideValues& psi, int terms, int padded) {
    std::vector<double> T(padded, 0.0);
    if (z.imag() >= 1) {
        for (int n = 1; n <= terms; ++n) {
            T[n] = psi.im[n - 1] * psi.re[n] - psi.re[n - 1] * psi.im[n];
        }
        return T;
    }
    const double slope = z.imag() / std::norm(z);
    T[0] = -0.5 * std::sinh(2 * z.imag());
    for (int n = 0; n < terms; ++n) {
        T[n + 1] = T[n] + (2 * n + 1) * slope * (psi.re[n] * psi.re[n] + psi.im[n] * psi.im[n]);
    }
    return T;
}

Lanes inside_at(const InsideValues& psi, int n, double) { return ConstLanes(&psi.re[n]); }
ComplexLanes inside_at(const InsideValues& psi, int n, Complex) {
    return {ConstLanes(&psi.re[n]), ConstLanes(&psi.im[n])};
}
Lanes multiply(double m, const Lanes& z) { return m * z; }
ComplexLanes multiply(Complex m, const ComplexLanes& z) {
    return {m.real() * z.re - m.imag() * z.im, m.real() * z.im + m.imag() * z.re};
}

// The formulas of sphere_block.cpp, with orders in the lanes in place of spheres.
template <typename Number>
PartialWaves by_vectors(Number m, double x) {
    const int terms = number_of_terms(x);
    PartialWaves waves(terms);
    const int padded = waves.vectors() * lane_count + 1;
    InsideValues inside;
    RadialFunctions radial;
    std::vector<double> sources;
    if constexpr (std::is_same_v<Number, double>) {
        inside.re.assign(padded, 1.0);
        radial = radial_functions(x, terms, inside.re.data(), m * x);
    } else {
        radial = radial_functions(x, terms);
        inside = inside_values(m * x, terms, padded);
        sources = absorption_sources(m * x, inside, terms, padded);
    }
    radial.psi.resize(padded, 0.0);
    radial.eta.resize(padded, 1.0);
    const Number m_minus_inverse = m - 1.0 / m;
    Lanes orders = Lanes::LinSpaced(lane_count, 1, lane_count);
    Response a, b;
    for (int n = 1; n <= terms; n += lane_count, orders += lane_count) {
        const Lanes psi = ConstLanes(&radial.psi[n]), eta = ConstLanes(&radial.eta[n]);
        const Lanes psi_before = ConstLanes(&radial.psi[n - 1]);
        const Lanes eta_before = ConstLanes(&radial.eta[n - 1]);
        const auto P = inside_at(inside, n, m), Q = inside_at(inside, n - 1, m);
        const Lanes n_over_x = orders / x;
        const auto A = plus(Q, times(multiply(m_minus_inverse, P), n_over_x));
        const auto mP = multiply(m, P), B = multiply(m, Q);
        respond(minus(times(A, psi), times(mP, psi_before)),
                minus(times(A, eta), times(mP, eta_before)),
                minus(times(B, psi), times(P, psi_before)),
                minus(times(B, eta), times(P, eta_before)), a, b);
        Eigen::Map<Lanes>(&waves.a_re[n]) = a.value.re;
        Eigen::Map<Lanes>(&waves.a_im[n]) = a.value.im;
        Eigen::Map<Lanes>(&waves.b_re[n]) = b.value.re;
        Eigen::Map<Lanes>(&waves.b_im[n]) = b.value.im;
        if constexpr (!std::is_same_v<Number, double>) {
            const Lanes T = ConstLanes(&sources[n]);
            const Lanes R = Q.re * P.re + Q.im * P.im;
            const double cross = 2 * m.real() * m.imag() / std::norm(m);
            const Lanes electric = m.real() * T - m.imag() * R + cross * n_over_x * norm(P);
            const Lanes magnetic = m.real() * T + m.imag() * R;
            Eigen::Map<Lanes>(&waves.absorbed[n]) =
                -(electric * a.inverse_norm + magnetic * b.inverse_norm);
        }
    }
    for (int n = terms + 1; n < padded; ++n) {
        waves.a_re[n] = waves.a_im[n] = waves.b_re[n] = waves.b_im[n] = waves.absorbed[n] = 0;
    }
    return waves;
}

PartialWaves by_coefficients(Complex m, double x) {
    const Coefficients c = mie_coefficients(m, x);
    PartialWaves waves(static_cast<int>(c.a.size()));
    for (std::size_t i = 0; i < c.a.size(); ++i) {
        waves.a_re[i + 1] = c.a[i].real();
        waves.a_im[i + 1] = c.a[i].imag();
        waves.b_re[i + 1] = c.b[i].real();
        waves.b_im[i + 1] = c.b[i].imag();
        waves.absorbed[i + 1] = c.absorbed[i];
    }
    return waves;
}

}  // namespace

PartialWaves::PartialWaves(int number_of_orders)
    : terms(number_of_orders),
      a_re(vectors() * lane_count + 1),
      a_im(a_re.size()),
      b_re(a_re.size()),
      b_im(a_re.size()),
      absorbed(a_re.size()) {}

PartialWaves partial_waves(Complex relative_index, double size_parameter) {
    const bool by_vector =
        size_parameter >= least_vector_size && size_parameter <= 1e7 &&
        std::abs(relative_index - 1.0) >= well_off_the_host && std::abs(relative_index) <= 100 &&
        relative_index.imag() >= 0 &&
        upward_is_stable(relative_index * size_parameter, number_of_terms(size_parameter));
    if (!by_vector) return by_coefficients(relative_index, size_parameter);
    if (relative_index.imag() == 0) return by_vectors(relative_index.real(), size_parameter);
    return by_vectors(relative_index, size_parameter);
}

}  // namespace miebrdf::mie
