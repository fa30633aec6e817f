// Numbers in one register of the machine, as the compiler's own vector type, for loops in which
// every temporary has to stay in a register (expressions of fixed-size arrays are not always
// inlined, and wider vector types than the machine's are kept in memory).
#pragma once

#include <cstring>
#include <utility>

#include "mie/sphere/lane_math.h"

namespace miebrdf::mie {

#if defined(__AVX512F__)
constexpr int kVectorSize = 8;
#elif defined(__AVX__)
constexpr int kVectorSize = 4;
#else
constexpr int kVectorSize = 2;
#endif
using Vector = double __attribute__((vector_size(kVectorSize * sizeof(double))));
using FloatVector = float __attribute__((vector_size(kVectorSize * sizeof(float))));
/// A vector of as many bytes as Vector: the same lanes of two numbers, say of both polarisations.
using FloatPair = float __attribute__((vector_size(kVectorSize * sizeof(double))));

#define MIEBRDF_VECTOR [[gnu::always_inline]] inline

/// Two halves of a register in one. Through memory they would wait for each other.
template <typename Half, int... kPlace>
MIEBRDF_VECTOR auto joined(const Half& low, const Half& high,
                           std::integer_sequence<int, kPlace...>) {
    return __builtin_shufflevector(low, high, kPlace...);
}
template <int kCount, typename Half>
MIEBRDF_VECTOR auto joined(const Half& low, const Half& high) {
    return joined(low, high, std::make_integer_sequence<int, kCount>{});
}

MIEBRDF_VECTOR FloatPair joined(const FloatVector& low, const FloatVector& high) {
    return joined<2 * kVectorSize>(low, high);
}
template <int kFirst, int... kPlace>
MIEBRDF_VECTOR FloatVector part_of(const FloatPair& pair, std::integer_sequence<int, kPlace...>) {
    return __builtin_shufflevector(pair, pair, (kFirst + kPlace)...);
}
MIEBRDF_VECTOR FloatVector low_half(const FloatPair& pair) {
    return part_of<0>(pair, std::make_integer_sequence<int, kVectorSize>{});
}
MIEBRDF_VECTOR FloatVector high_half(const FloatPair& pair) {
    return part_of<kVectorSize>(pair, std::make_integer_sequence<int, kVectorSize>{});
}

/// Some of eight lanes: kVectorSize of them from `first` on.
MIEBRDF_VECTOR Vector load(const Lanes& lanes, int first) {
    Vector v;
    std::memcpy(&v, lanes.data() + first, sizeof v);
    return v;
}
MIEBRDF_VECTOR void store(const Vector& v, Lanes& lanes, int first) {
    std::memcpy(lanes.data() + first, &v, sizeof v);
}
MIEBRDF_VECTOR FloatVector single(const Vector& v) {
    return __builtin_convertvector(v, FloatVector);
}
MIEBRDF_VECTOR void store(const FloatVector& v, float* to) { std::memcpy(to, &v, sizeof v); }
MIEBRDF_VECTOR void store(const Vector& v, float* to) { store(single(v), to); }

/// Complex numbers in double or in single precision.
template <typename RealVector>
struct ComplexOf {
    RealVector re, im;
};
using ComplexVector = ComplexOf<Vector>;
using ComplexFloatPair = ComplexOf<FloatPair>;

MIEBRDF_VECTOR ComplexVector load(const ComplexLanes& z, int first) {
    return {load(z.re, first), load(z.im, first)};
}
MIEBRDF_VECTOR void store(const ComplexVector& z, ComplexLanes& to, int first) {
    store(z.re, to.re, first);
    store(z.im, to.im, first);
}

template <typename Real>
MIEBRDF_VECTOR ComplexOf<Real> operator+(const ComplexOf<Real>& a, const ComplexOf<Real>& b) {
    return {a.re + b.re, a.im + b.im};
}
template <typename Real>
MIEBRDF_VECTOR ComplexOf<Real> operator-(const ComplexOf<Real>& a, const ComplexOf<Real>& b) {
    return {a.re - b.re, a.im - b.im};
}
template <typename Real>
MIEBRDF_VECTOR ComplexOf<Real> operator*(const ComplexOf<Real>& a, const ComplexOf<Real>& b) {
    return {a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re};
}
template <typename Real>
MIEBRDF_VECTOR ComplexOf<Real> operator*(const Real& a, const ComplexOf<Real>& b) {
    return {a * b.re, a * b.im};
}
MIEBRDF_VECTOR ComplexVector operator*(double a, const ComplexVector& b) {
    return {a * b.re, a * b.im};
}
MIEBRDF_VECTOR ComplexVector operator*(std::complex<double> a, const ComplexVector& b) {
    return {a.real() * b.re - a.imag() * b.im, a.real() * b.im + a.imag() * b.re};
}
template <typename Real>
MIEBRDF_VECTOR ComplexOf<Real> conjugate(const ComplexOf<Real>& z) {
    return {z.re, -z.im};
}
template <typename Real>
MIEBRDF_VECTOR Real norm(const ComplexOf<Real>& z) {
    return z.re * z.re + z.im * z.im;
}
template <typename Real>
MIEBRDF_VECTOR ComplexOf<Real> power(const ComplexOf<Real>& z, int exponent) {
    ComplexOf<Real> result{Real{} + 1, Real{}}, square = z;
    for (; exponent > 0; exponent /= 2) {
        if (exponent % 2 == 1) result = result * square;
        square = square * square;
    }
    return result;
}
MIEBRDF_VECTOR ComplexVector inverse(const ComplexVector& z) {
    const Vector scale = 1 / norm(z);
    return {z.re * scale, -z.im * scale};
}

}  // namespace miebrdf::mie
