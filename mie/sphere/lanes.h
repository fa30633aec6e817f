// Eight numbers in one vector: the arithmetic of several spheres at once.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <type_traits>

namespace miebrdf::mie {

constexpr int lane_count = 8;  // one AVX-512 register; two or four registers elsewhere
using Lanes = Eigen::Array<double, lane_count, 1>;

/// Complex numbers, real and imaginary parts apart.
struct ComplexLanes {
    Lanes re, im;
};

inline Lanes real_part(const Lanes& z) { return z; }
inline Lanes real_part(const ComplexLanes& z) { return z.re; }
inline Lanes norm(const Lanes& z) { return z * z; }
inline Lanes norm(const ComplexLanes& z) { return z.re * z.re + z.im * z.im; }
inline Lanes times(const Lanes& a, const Lanes& b) { return a * b; }
inline ComplexLanes times(const ComplexLanes& a, const Lanes& b) { return {a.re * b, a.im * b}; }
inline ComplexLanes times(const ComplexLanes& a, const ComplexLanes& b) {
    return {a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re};
}
inline Lanes times(double m, const Lanes& a) { return m * a; }
inline ComplexLanes times(std::complex<double> m, const ComplexLanes& a) {
    return {m.real() * a.re - m.imag() * a.im, m.real() * a.im + m.imag() * a.re};
}
inline Lanes minus(const Lanes& a, const Lanes& b) { return a - b; }
inline ComplexLanes minus(const ComplexLanes& a, const ComplexLanes& b) {
    return {a.re - b.re, a.im - b.im};
}
inline Lanes plus(const Lanes& a, const Lanes& b) { return a + b; }
inline ComplexLanes plus(const ComplexLanes& a, const ComplexLanes& b) {
    return {a.re + b.re, a.im + b.im};
}

/// Lanes of the kind of Number (double or std::complex<double>).
template <typename Number>
using LanesOf = std::conditional_t<std::is_same_v<Number, double>, Lanes, ComplexLanes>;

}  // namespace miebrdf::mie
