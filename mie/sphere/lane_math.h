// Eight numbers in one vector, for eight spheres or eight orders at once: their arithmetic, and a_n
// and b_n from the waves on both sides of a sphere's boundary.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <type_traits>

namespace miebrdf::mie {

constexpr int kLaneCount = 8;  // one AVX-512 register; two or four registers elsewhere
using Lanes = Eigen::Array<double, kLaneCount, 1>;

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

inline Lanes reciprocal(const Lanes& z) { return 1 / z; }
inline ComplexLanes reciprocal(const ComplexLanes& z) {
    const Lanes scale = 1 / norm(z);
    return {z.re * scale, -z.im * scale};
}

/// m x, the size parameters inside spheres of index m.
inline Lanes inside_parameter(double m, const Lanes& x) { return m * x; }
inline ComplexLanes inside_parameter(std::complex<double> m, const Lanes& x) {
    return {m.real() * x, m.imag() * x};
}

/// Lanes of the kind of Number (double or std::complex<double>).
template <typename Number>
using LanesOf = std::conditional_t<std::is_same_v<Number, double>, Lanes, ComplexLanes>;

/// a_n or b_n: p / (p + i q), and 1 / |p + i q|^2 for the absorption.
struct Response {
    ComplexLanes value;
    Lanes inverse_norm;
};

/// Both at once: they share the one division.
inline void respond(const Lanes& pa, const Lanes& qa, const Lanes& pb, const Lanes& qb, Response& a,
                    Response& b) {
    const Lanes norm_a = pa * pa + qa * qa;
    const Lanes norm_b = pb * pb + qb * qb;
    const Lanes shared = 1 / (norm_a * norm_b);
    const Lanes factor_a = pa * norm_b * shared;
    const Lanes factor_b = pb * norm_a * shared;
    a.value = {pa * factor_a, -qa * factor_a};
    b.value = {pb * factor_b, -qb * factor_b};
}

inline void respond(const ComplexLanes& pa, const ComplexLanes& qa, const ComplexLanes& pb,
                    const ComplexLanes& qb, Response& a, Response& b) {
    const ComplexLanes da = {pa.re - qa.im, pa.im + qa.re};
    const ComplexLanes db = {pb.re - qb.im, pb.im + qb.re};
    const Lanes norm_a = norm(da);
    const Lanes norm_b = norm(db);
    const Lanes shared = 1 / (norm_a * norm_b);
    a.inverse_norm = norm_b * shared;
    b.inverse_norm = norm_a * shared;
    a.value = {(pa.re * da.re + pa.im * da.im) * a.inverse_norm,
               (pa.im * da.re - pa.re * da.im) * a.inverse_norm};
    b.value = {(pb.re * db.re + pb.im * db.im) * b.inverse_norm,
               (pb.im * db.re - pb.re * db.im) * b.inverse_norm};
}

/// The boundary of a sphere of relative index m (Number: double or std::complex<double>).
///
/// Symbols of mie_coefficients. The inside wave enters by P = psi_n(mx) and Q = psi_{n-1}(mx) up to
/// a factor: times P, and for a_n times m, with D_n = Q/P - n/(mx),
///     a_n: A = Q + (n/x) (m - 1/m) P with mP for 1;  b_n: A = m Q with P for 1.
template <typename Number>
class Boundary {
  public:
    using Values = LanesOf<Number>;

    explicit Boundary(Number m)
        : m_(m), m_minus_inverse_(m - 1.0 / m), n_(std::real(m)), k_(std::imag(m)) {
        cross_ = 2 * n_ * k_ / std::norm(m);
    }

    void scatter(const Values& P, const Values& Q, const Lanes& psi, const Lanes& psi_before,
                 const Lanes& eta, const Lanes& eta_before, const Lanes& n_over_x, Response& a,
                 Response& b) const {
        const Values A = plus(Q, times(times(m_minus_inverse_, P), n_over_x));
        const Values mP = times(m_, P), B = times(m_, Q);
        respond(minus(times(A, psi), times(mP, psi_before)),
                minus(times(A, eta), times(mP, eta_before)),
                minus(times(B, psi), times(P, psi_before)),
                minus(times(B, eta), times(P, eta_before)), a, b);
    }

    /// (Re a - |a|^2) + (Re b - |b|^2) from T = Im(Q conj P), in the scale of P and Q.
    Lanes absorbed(const ComplexLanes& P, const ComplexLanes& Q, const Lanes& T,
                   const Lanes& n_over_x, const Response& a, const Response& b) const {
        const Lanes R = Q.re * P.re + Q.im * P.im;
        const Lanes electric = n_ * T - k_ * R + cross_ * n_over_x * norm(P);
        const Lanes magnetic = n_ * T + k_ * R;
        return -(electric * a.inverse_norm + magnetic * b.inverse_norm);
    }

  private:
    Number m_, m_minus_inverse_;
    double n_, k_, cross_;
};

}  // namespace miebrdf::mie
