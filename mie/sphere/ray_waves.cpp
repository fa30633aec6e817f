#include "mie/sphere/ray_waves.h"

#include <type_traits>

namespace miebrdf::mie {
namespace {

using Complex = std::complex<double>;

Lanes real_z(double m, const Lanes& x) { return m * x; }
ComplexLanes complex_z(Complex m, const Lanes& x) { return {m.real() * x, m.imag() * x}; }

Lanes inverse_of(const Lanes& z) { return 1 / z; }
ComplexLanes inverse_of(const ComplexLanes& z) {
    const Lanes scale = 1 / norm(z);
    return {z.re * scale, -z.im * scale};
}

Lanes scaled_by(const Lanes& z, double factor) { return z * factor; }
ComplexLanes scaled_by(const ComplexLanes& z, double factor) {
    return {z.re * factor, z.im * factor};
}

ComplexLanes conjugate(const ComplexLanes& z) { return {z.re, -z.im}; }

ComplexLanes selected(const Lanes& going, const ComplexLanes& a, const ComplexLanes& b) {
    return {(going > 0).select(a.re, b.re), (going > 0).select(a.im, b.im)};
}

// -a / b and factor / b^2, with one division.
struct Quotients {
    ComplexLanes inverse;
    explicit Quotients(const ComplexLanes& b) {
        const Lanes scale = 1 / norm(b);
        inverse = {b.re * scale, -b.im * scale};
    }
    ComplexLanes minus_over(const ComplexLanes& a) const {
        const ComplexLanes q = times(a, inverse);
        return {-q.re, -q.im};
    }
};

}  // namespace

template <typename Number>
RayWaves<Number>::RayWaves(Number m, const Lanes& x) : m_(m), outside_(x) {
    if constexpr (std::is_same_v<Number, double>) {
        const Lanes z = real_z(m, x);
        inverse_z_ = inverse_of(z);
        // zeta_0 = -i exp(iz), zeta_{-1} = exp(iz), here without the factor.
        round_ = {(2 * z).cos(), (2 * z).sin()};
    } else {
        const ComplexLanes z = complex_z(m, x);
        inverse_z_ = inverse_of(z);
        const Lanes damping = (-2 * z.im).exp();
        round_ = {damping * (2 * z.re).cos(), damping * (2 * z.re).sin()};
    }
    out_ = {{Lanes::Zero(), -Lanes::Ones()}, {Lanes::Ones(), Lanes::Zero()}};
    in_ = {conjugate(out_.here), conjugate(out_.before)};
}

template <typename Number>
void RayWaves<Number>::advance(const Lanes& last_order, RayResponse& a, RayResponse& b) {
    ++order_;
    const Lanes alive = (last_order >= order_).select(Lanes::Ones(), Lanes::Zero());
    const bool all_alive = last_order.minCoeff() >= order_;
    const auto step = [&](Wave& wave) {
        const ComplexLanes next =
            minus(times(wave.here, scaled_by(inverse_z_, 2 * order_ - 1)), wave.before);
        const Wave old = wave;
        wave.before = wave.here;
        wave.here = next;
        if (all_alive) return;  // before it overflows
        wave.before = selected(alive, wave.before, old.before);
        wave.here = selected(alive, wave.here, old.here);
    };
    step(out_);
    if (all_alive) {
        outside_.advance(order_);
    } else {
        outside_.advance_some(order_, last_order);
    }
    if constexpr (std::is_same_v<Number, double>) {
        in_ = {conjugate(out_.here), conjugate(out_.before)};
    } else {
        step(in_);
    }
    const Lanes n_over_x = order_ * outside_.inverse_x;
    const Number m_minus_inverse = m_ - 1.0 / m_;
    const ComplexLanes X = {outside_.psi, outside_.eta};
    const ComplexLanes X_before = {outside_.psi_before, outside_.eta_before};
    const auto respond = [&](auto G, RayResponse& response) {
        const ComplexLanes N = G(X, X_before, in_);
        const ComplexLanes inner = G(X, X_before, out_);
        const ComplexLanes outer = std::is_same_v<Number, double>
                                       ? conjugate(inner)
                                       : G(conjugate(X), conjugate(X_before), in_);
        const Quotients over_N(N);
        response.outer = over_N.minus_over(outer);
        response.inner = times(over_N.minus_over(inner), round_);
        const ComplexLanes square = times(over_N.inverse, over_N.inverse);
        response.through = times(times(Number(-4.0) * m_, square), round_);
        response.outer = selected(alive, response.outer, {Lanes::Ones(), Lanes::Zero()});
        response.inner = times(response.inner, alive);
        response.through = times(response.through, alive);
    };
    respond(
        [&](const ComplexLanes& x, const ComplexLanes& x_before, const Wave& z) {
            const ComplexLanes A =
                plus(z.before, times(times(m_minus_inverse, z.here), n_over_x));
            return minus(times(times(m_, z.here), x_before), times(A, x));
        },
        a);
    respond(
        [&](const ComplexLanes& x, const ComplexLanes& x_before, const Wave& z) {
            return minus(times(z.here, x_before), times(times(m_, z.before), x));
        },
        b);
}

template class RayWaves<double>;
template class RayWaves<Complex>;

}  // namespace miebrdf::mie
