// Numbers in one register of the machine, as the compiler's own vector type, for loops in which
// every temporary has to stay in a register (expressions of fixed-size arrays are not always
// inlined, and wider vector types than the machine's are kept in memory).
#pragma once

#include <cstring>

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

#define MIEBRDF_VECTOR [[gnu::always_inline]] inline

/// Some of eight lanes: kVectorSize of them from `first` on.
MIEBRDF_VECTOR Vector load(const Lanes& lanes, int first) {
    Vector v;
    std::memcpy(&v, lanes.data() + first, sizeof v);
    return v;
}
MIEBRDF_VECTOR void store(const Vector& v, Lanes& lanes, int first) {
    std::memcpy(lanes.data() + first, &v, sizeof v);
}
MIEBRDF_VECTOR void store(const Vector& v, float* to) {
    const FloatVector single = __builtin_convertvector(v, FloatVector);
    std::memcpy(to, &single, sizeof single);
}

struct ComplexVector {
    Vector re, im;
};

MIEBRDF_VECTOR ComplexVector load(const ComplexLanes& z, int first) {
    return {load(z.re, first), load(z.im, first)};
}
MIEBRDF_VECTOR void store(const ComplexVector& z, ComplexLanes& to, int first) {
    store(z.re, to.re, first);
    store(z.im, to.im, first);
}

MIEBRDF_VECTOR ComplexVector operator+(const ComplexVector& a, const ComplexVector& b) {
    return {a.re + b.re, a.im + b.im};
}
MIEBRDF_VECTOR ComplexVector operator-(const ComplexVector& a, const ComplexVector& b) {
    return {a.re - b.re, a.im - b.im};
}
MIEBRDF_VECTOR ComplexVector operator*(const ComplexVector& a, const ComplexVector& b) {
    return {a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re};
}
MIEBRDF_VECTOR ComplexVector operator*(const Vector& a, const ComplexVector& b) {
    return {a * b.re, a * b.im};
}
MIEBRDF_VECTOR ComplexVector operator*(double a, const ComplexVector& b) {
    return {a * b.re, a * b.im};
}
MIEBRDF_VECTOR ComplexVector operator*(std::complex<double> a, const ComplexVector& b) {
    return {a.real() * b.re - a.imag() * b.im, a.real() * b.im + a.imag() * b.re};
}
MIEBRDF_VECTOR ComplexVector conjugate(const ComplexVector& z) { return {z.re, -z.im}; }
MIEBRDF_VECTOR Vector norm(const ComplexVector& z) { return z.re * z.re + z.im * z.im; }
MIEBRDF_VECTOR ComplexVector inverse(const ComplexVector& z) {
    const Vector scale = 1 / norm(z);
    return {z.re * scale, -z.im * scale};
}

}  // namespace miebrdf::mie
