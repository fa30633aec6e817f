#include "mie/sphere/ray_waves.h"

#include <type_traits>

#include "mie/sphere/vectors.h"

namespace miebrdf::mie {
namespace {

using Complex = std::complex<double>;

Lanes inside_of(double m, const Lanes& x) { return m * x; }
ComplexLanes inside_of(Complex m, const Lanes& x) { return {m.real() * x, m.imag() * x}; }

Lanes inverse_of(const Lanes& z) { return 1 / z; }
ComplexLanes inverse_of(const ComplexLanes& z) {
    const Lanes scale = 1 / norm(z);
    return {z.re * scale, -z.im * scale};
}

// A wave at n and n - 1.
struct WavePair {
    ComplexVector here, before;
};

// G of a_n, times m.
// @param slope  m - 1 / m
template <typename Number>
MIEBRDF_VECTOR ComplexVector electric(Number m, Number slope, const WavePair& x, const WavePair& z,
                                      const Vector& n_over_x) {
    return (m * z.here) * x.before - (z.before + n_over_x * (slope * z.here)) * x.here;
}

template <typename Number>
MIEBRDF_VECTOR ComplexVector magnetic(Number m, const WavePair& x, const WavePair& z) {
    return z.here * x.before - (m * z.before) * x.here;
}

MIEBRDF_VECTOR WavePair conjugate(const WavePair& wave) {
    return {conjugate(wave.here), conjugate(wave.before)};
}

// -1 / N, times what the waves that come back are.
template <typename Number>
MIEBRDF_VECTOR void respond(Number m, const ComplexVector& N, const ComplexVector& inner,
                            const ComplexVector& outer, const ComplexVector& round,
                            RayResponse& response, int first) {
    const ComplexVector minus_over_N = inverse(ComplexVector{-N.re, -N.im});
    const ComplexVector once = minus_over_N * round;
    store(outer * minus_over_N, response.outer, first);
    store(inner * once, response.inner, first);
    store((Number(-4.0) * m) * (minus_over_N * once), response.through, first);
}

// Lanes past their last order; what has overflowed there is not looked at.
void silence(const Lanes& last_order, int order, RayResponse& response) {
    for (int first = 0; first < kLaneCount; first += kVectorSize) {
        const auto alive = load(last_order, first) >= Vector{} + order;
        const Vector none{};
        const auto keep = [&](Lanes & lanes, const Vector& otherwise)
            __attribute__((always_inline)) {
            store(alive ? load(lanes, first) : otherwise, lanes, first);
        };
        keep(response.outer.re, none + 1);
        keep(response.outer.im, none);
        for (ComplexLanes* z : {&response.inner, &response.through}) {
            keep(z->re, none);
            keep(z->im, none);
        }
    }
}

}  // namespace

template <typename Number>
RayWaves<Number>::RayWaves(Number m, const Lanes& x) : m_(m), slope_(m - 1.0 / m), outside_(x) {
    const auto z = inside_of(m, x);
    inverse_z_ = inverse_of(z);
    // zeta_0 = -i exp(iz), zeta_{-1} = exp(iz), here without the factor.
    out_ = {{Lanes::Zero(), -Lanes::Ones()}, {Lanes::Ones(), Lanes::Zero()}};
    in_ = {{Lanes::Zero(), Lanes::Ones()}, {Lanes::Ones(), Lanes::Zero()}};
    const Lanes turns = 2 * real_part(z);
    round_ = {turns.cos(), turns.sin()};
    if constexpr (!std::is_same_v<Number, double>) {
        const Lanes damping = (-2 * z.im).exp();
        round_ = times(round_, damping);
    }
}

template <typename Number>
void RayWaves<Number>::advance(const Lanes& last_order, RayResponse& a, RayResponse& b) {
    ++order_;
    for (int first = 0; first < kLaneCount; first += kVectorSize) advance_some(first, a, b);
    if (last_order.minCoeff() >= order_) return;
    silence(last_order, order_, a);
    silence(last_order, order_, b);
}

template <typename Number>
void RayWaves<Number>::advance_some(int first, RayResponse& a, RayResponse& b) {
    constexpr bool is_real = std::is_same_v<Number, double>;
    const double odd = 2 * order_ - 1;
    const auto inverse_z = load(inverse_z_, first);
    const auto step = [&](Wave & wave) __attribute__((always_inline)) {
        const ComplexVector here = load(wave.here, first);
        const WavePair next{odd * (inverse_z * here) - load(wave.before, first), here};
        store(next.here, wave.here, first);
        store(next.before, wave.before, first);
        return next;
    };
    const WavePair out = step(out_);
    WavePair in;
    if constexpr (is_real) {
        in = conjugate(out);
    } else {
        in = step(in_);
    }
    const Vector inverse_x = load(outside_.inverse_x, first);
    const Vector psi = load(outside_.psi, first), eta = load(outside_.eta, first);
    const WavePair x{{odd * inverse_x * psi - load(outside_.psi_before, first),
                      odd * inverse_x * eta - load(outside_.eta_before, first)},
                     {psi, eta}};
    store(x.here.re, outside_.psi, first);
    store(x.here.im, outside_.eta, first);
    store(psi, outside_.psi_before, first);
    store(eta, outside_.eta_before, first);

    const Vector n_over_x = static_cast<double>(order_) * inverse_x;
    const ComplexVector round = load(round_, first);
    const ComplexVector inner_a = electric(m_, slope_, x, out, n_over_x);
    const ComplexVector inner_b = magnetic(m_, x, out);
    const ComplexVector N_a = electric(m_, slope_, x, in, n_over_x);
    const ComplexVector N_b = magnetic(m_, x, in);
    if constexpr (is_real) {
        respond(m_, N_a, inner_a, conjugate(inner_a), round, a, first);
        respond(m_, N_b, inner_b, conjugate(inner_b), round, b, first);
    } else {
        const WavePair x_in = conjugate(x);
        respond(m_, N_a, inner_a, electric(m_, slope_, x_in, in, n_over_x), round, a, first);
        respond(m_, N_b, inner_b, magnetic(m_, x_in, in), round, b, first);
    }
}

template class RayWaves<double>;
template class RayWaves<Complex>;

}  // namespace miebrdf::mie
