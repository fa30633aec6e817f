// Mie coefficients of one sphere, order after order.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <type_traits>

#include <miebrdf/error.h>
#include <miebrdf/sphere.h>
#include "mie/sphere/faint_absorption.h"
#include "mie/sphere/lane_layers.h"
#include "mie/sphere/radial_functions.h"

namespace miebrdf::mie {
namespace {

using Complex = std::complex<double>;

void validate_index(Complex m) {
    if (!(m.real() >= 0.01 && m.real() <= 100 && m.imag() >= 0 && m.imag() <= 1e4)) {
        throw UsageError("relative_index", fmt::format("{} + {}i", m.real(), m.imag()),
                         "n in [0.01, 100], k in [0, 10000]");
    }
}

void validate_size(double x) {
    if (!(x >= 1e-30 && x <= 1e7)) {
        throw UsageError("size_parameter", x, "1e-30 to 1e7");
    }
}

// p / (p + i q), with q real or complex.
template <typename Number>
Complex response(Number p, Number q) {
    if constexpr (std::is_same_v<Number, double>) {
        const double scale = 1 / (p * p + q * q);
        return {p * p * scale, -p * q * scale};
    } else {
        const Complex d(p.real() - q.imag(), p.imag() + q.real());
        const double scale = 1 / std::norm(d);
        return {(p.real() * d.real() + p.imag() * d.imag()) * scale,
                (p.imag() * d.real() - p.real() * d.imag()) * scale};
    }
}

template <typename Number>
double absorbed(Number A, Number p, Number q) {
    if constexpr (std::is_same_v<Number, double>) {
        return 0;
    } else {
        return -A.imag() / std::norm(Complex(p.real() - q.imag(), p.imag() + q.real()));
    }
}

// Order n from what differs between a_n and b_n: A and p.
template <typename Number>
void set_order(Coefficients& c, int n, Number Aa, Number pa, Number Ab, Number pb,
               const RadialFunctions& radial) {
    const Number qa = Aa * radial.eta[n] - radial.eta[n - 1];
    const Number qb = Ab * radial.eta[n] - radial.eta[n - 1];
    c.a[n - 1] = response(pa, qa);
    c.b[n - 1] = response(pb, qb);
    c.absorbed[n - 1] = absorbed(Aa, pa, qa) + absorbed(Ab, pb, qb);
}

Coefficients empty(int terms) {
    return {std::vector<Complex>(terms), std::vector<Complex>(terms), std::vector<double>(terms)};
}

// From the logarithmic derivatives of the waves inside, at the surface: those of a_n and of b_n.
// Number: double where all indices are real, else complex.
template <typename Number>
Coefficients by_recurrence(Number m, double x, const std::vector<Number>& Da,
                           const std::vector<Number>& Db) {
    const int terms = number_of_terms(x);
    const RadialFunctions radial = radial_functions(x, terms);
    const auto& psi = radial.psi;
    const Number inverse_m = 1.0 / m;
    Coefficients c = empty(terms);
    for (int n = 1; n <= terms; ++n) {
        const Number A = Da[n] * inverse_m + n / x;
        const Number B = Db[n] * m + n / x;
        set_order<Number>(c, n, A, A * psi[n] - psi[n - 1], B, B * psi[n] - psi[n - 1], radial);
    }
    return c;
}

template <typename Number>
Coefficients by_recurrence(Number m, double x) {
    const std::vector<Number> D = logarithmic_derivatives(m * x, number_of_terms(x));
    return by_recurrence(m, x, D, D);
}

// p of b_n is psi_n (m D_n(mx) - D_n(x)), a difference that vanishes as x^2 relative to its parts,
// so b_1 (and with it the asymmetry) would lose all digits at x = 1e-8. With E_n = z D_n - (n + 1)
// it is
//     p_b = psi_n Delta_n / x,  p_a = psi_n [(1 - m^2) (n + 1 + E_n(x)) + Delta_n] / (m^2 x),
//     Delta_n = E_n(mx) - E_n(x) = [x^2 Delta_{n+1} - (m^2 - 1) x^2 B] / [B (B + Delta_{n+1})],
// B = 2n + 3 + E_{n+1}(x): no term is a difference of nearly equal numbers, also for m near 1.
template <typename Number>
Coefficients of_small_sphere(Number m, double x) {
    const int terms = number_of_terms(x);
    const RadialFunctions radial = radial_functions(x, terms);
    const auto& psi = radial.psi;
    const int start = terms + 30;  // |mx| <= 4: the start is forgotten below rounding
    const std::vector<double> E = regular_logarithmic_derivatives(x, start + 1);
    const Number m_squared = m * m;
    const Number contrast = (m - 1.0) * (m + 1.0);
    Coefficients c = empty(terms);
    Number Delta = -contrast * x * x / (2.0 * start + 5.0);
    for (int n = start; n >= 1; --n) {
        const double B = 2 * n + 3 + E[n + 1];
        Delta = x * x * (Delta - contrast * B) / (B * (B + Delta));
        if (n > terms) continue;
        const Number E_inside = E[n] + Delta;
        const Number pa = psi[n] * (Delta - contrast * (n + 1 + E[n])) / (m_squared * x);
        const Number pb = psi[n] * Delta / x;
        const Number Aa = ((n + 1.0 + E_inside) / m_squared + static_cast<double>(n)) / x;
        const Number Ab = (2.0 * n + 1.0 + E_inside) / x;
        set_order<Number>(c, n, Aa, pa, Ab, pb, radial);
    }
    return c;
}

// One of eight spheres whose waves inside are known; m of the layer at their surface.
Coefficients of_lane(const LayeredInside& inside, int lane, Complex m, double x, bool absorbs) {
    std::vector<Complex> Ha, Hb;
    std::vector<double> real_a, real_b;
    for (int n = 0; n <= number_of_terms(x); ++n) {
        Ha.emplace_back(inside.electric[n].re[lane], inside.electric[n].im[lane]);
        Hb.emplace_back(inside.magnetic[n].re[lane], inside.magnetic[n].im[lane]);
        real_a.push_back(Ha.back().real());
        real_b.push_back(Hb.back().real());
    }
    return absorbs ? by_recurrence(m, x, Ha, Hb) : by_recurrence(m.real(), x, real_a, real_b);
}

// Waves go through the layers for eight sizes at once; here all are alike.
Coefficients of_layers(std::span<const SphereLayer> layers) {
    std::vector<LaneLayer> lanes;
    for (const SphereLayer& layer : layers)
        lanes.push_back({layer.relative_index, Lanes::Constant(layer.size_parameter)});
    return layered_coefficients(lanes).front();
}

template <typename Number>
Coefficients coefficients_of(Number m, double x) {
    // 0.5: above, the cancellation costs less than one digit. 4: no zero of psi_n(mx) below.
    const bool small = x < 0.5 && std::abs(m) * x < 4;
    return small ? of_small_sphere(m, x) : by_recurrence(m, x);
}

}  // namespace

std::array<Coefficients, kLaneCount> layered_coefficients(std::span<const LaneLayer> layers) {
    const Lanes x = layers.back().size_parameter;
    Complex m = layers.front().relative_index;  // of the outermost layer that is there
    bool absorbs = m.imag() > 0;
    for (std::size_t i = 1; i < layers.size(); ++i) {
        if ((layers[i].size_parameter > layers[i - 1].size_parameter).all())
            m = layers[i].relative_index;
        absorbs = absorbs || layers[i].relative_index.imag() > 0;
    }
    const LayeredInside& inside = layered_inside(layers, number_of_terms(x.maxCoeff()));
    std::array<Coefficients, kLaneCount> spheres;
    for (int lane = 0; lane < kLaneCount; ++lane)
        spheres[lane] = of_lane(inside, lane, m, x[lane], absorbs);
    return spheres;
}

Coefficients mie_coefficients(Complex relative_index, double size_parameter) {
    validate_index(relative_index);
    validate_size(size_parameter);
    if (relative_index.imag() == 0) return coefficients_of(relative_index.real(), size_parameter);
    const FaintAbsorption faint(relative_index);
    Coefficients c = coefficients_of(faint.index, size_parameter);
    for (double& absorbed : c.absorbed) absorbed *= faint.share;
    return c;
}

Coefficients mie_coefficients(std::span<const SphereLayer> layers) {
    if (layers.empty()) throw UsageError("a sphere without layers; allowed: a core at least");
    double before = 0;
    for (const SphereLayer& layer : layers) {
        validate_index(layer.relative_index);
        validate_size(layer.size_parameter);
        if (!(layer.size_parameter >= before)) {
            throw UsageError("size_parameter", layer.size_parameter,
                             fmt::format("{} or more, that of the layer below", before));
        }
        before = layer.size_parameter;
    }
    const bool is_plain = std::all_of(layers.begin(), layers.end(), [&](const SphereLayer& layer) {
        return layer.relative_index == layers.front().relative_index;
    });
    if (is_plain || layers.front().size_parameter == before)
        return mie_coefficients(layers.front().relative_index, before);
    return of_layers(layers);
}

}  // namespace miebrdf::mie
