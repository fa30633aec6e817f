// The orders of one large sphere in eight segments, one in each lane of a vector, and the waves at
// the ends of the segments.
#pragma once

#include <array>
#include <cmath>
#include <complex>
#include <type_traits>

#include "mie/sphere/vectors.h"

namespace miebrdf::mie {

template <typename Number>
constexpr bool kReal = std::is_same_v<Number, double>;
template <typename Number>
using VectorOf = std::conditional_t<kReal<Number>, Vector, ComplexVector>;

inline std::complex<double> product(std::complex<double> a, std::complex<double> b) {
    return {a.real() * b.real() - a.imag() * b.imag(), a.real() * b.imag() + a.imag() * b.real()};
}
inline double bound_of(double z) { return std::abs(z); }
inline double bound_of(std::complex<double> z) { return std::abs(z.real()) + std::abs(z.imag()); }

MIEBRDF_VECTOR Vector norm(const Vector& z) { return z * z; }
MIEBRDF_VECTOR Vector magnitude(const Vector& z) { return z < 0 ? -z : z; }
MIEBRDF_VECTOR Vector bound_of(const Vector& z) { return magnitude(z); }
MIEBRDF_VECTOR Vector bound_of(const ComplexVector& z) { return magnitude(z.re) + magnitude(z.im); }

/// Orders first + 1 ... first + 8 length: segment j ends at first + (j + 1) length.
struct Segments {
    int first, length;
    int end() const { return first + kLaneCount * length; }
    MIEBRDF_VECTOR Vector bottoms(int first_lane) const {
        Vector orders;
        for (int i = 0; i < kVectorSize; ++i) orders[i] = first + (first_lane + i) * length;
        return orders;
    }
};

/// f_n and f_{n-1} at the end of a segment; T as AbsorptionSource has it, in their scale.
template <typename Number>
struct Wave {
    Number here, before;
    double T = 0;

    /// Inside waves hold in any scale.
    void normalise() {
        const double scale = 1 / (bound_of(here) + bound_of(before));
        here *= scale;
        before *= scale;
        T *= scale * scale;
    }
};

/// Waves at the upper ends of the eight segments.
template <typename Number>
using EndWaves = std::array<Wave<Number>, kLaneCount>;

/// A size parameter and what rounding has taken from it: x rounding errors of a radian are seen at
/// the back of a large sphere.
template <typename Number>
struct Parameter {
    Number value, rest;

    Wave<Number> order_zero() const {
        const Number sine = std::sin(value), cosine = std::cos(value);
        return {sine + rest * cosine, cosine - rest * sine};
    }
};

inline Parameter<double> inside_parameter(double m, double x) {
    return {m * x, std::fma(m, x, -m * x)};
}
inline Parameter<std::complex<double>> inside_parameter(std::complex<double> m, double x) {
    return {m * x, {std::fma(m.real(), x, -m.real() * x), 0}};
}

/// (2n - 1)/z, with 1/z in two parts: rounded once for all orders it would be another sphere's.
struct RealFactor {
    explicit RealFactor(const Parameter<double>& z)
        : high(1 / z.value), low(high * (std::fma(-z.value, high, 1) - z.rest * high)) {}
    template <typename Odd>
    MIEBRDF_VECTOR Odd of(const Odd& odd) const {
        return odd * high + odd * low;
    }
    double bound() const { return std::abs(high); }
    double high, low;
};
// Damping needs no such care.
struct ComplexFactor {
    explicit ComplexFactor(const Parameter<std::complex<double>>& z) : high(1.0 / z.value) {
        const double left = std::fma(-z.value.real(), high.real(), 1);
        low = high.real() * (left + z.value.imag() * high.imag() - z.rest.real() * high.real());
    }
    MIEBRDF_VECTOR ComplexVector of(const Vector& odd) const {
        return {odd * high.real() + odd * low, odd * high.imag()};
    }
    double bound() const { return std::abs(high); }
    std::complex<double> high;
    double low;  // of the real part
};
template <typename Number>
using Factor = std::conditional_t<kReal<Number>, RealFactor, ComplexFactor>;

/// psi_n(x) and eta_n(x) at the upper ends of segments.
struct OutsideEnds {
    EndWaves<double> psi, eta;
};

/// For segments from order 0 to x at most, where both waves oscillate.
OutsideEnds outside_ends(const Segments& segments, double x);

/// psi_n(z), in any scale, and T at the upper ends of two lots of segments, one above the other.
template <typename Number>
struct InsideEnds {
    EndWaves<Number> lower, upper;
};

/// @param lower  from order 0
/// @param upward  whether psi_n(z) can be taken upward to the last order (upward_is_stable)
template <typename Number>
InsideEnds<Number> inside_ends(const Segments& lower, const Segments& upper,
                               const Parameter<Number>& z, bool upward);

}  // namespace miebrdf::mie
