#include "mie/sphere/ray_waves.h"

#include <type_traits>

#include "mie/sphere/radial_functions.h"
#include "mie/sphere/vectors.h"

namespace miebrdf::mie {
namespace {

using Complex = std::complex<double>;

// A wave at n and n - 1.
struct WavePair {
    ComplexVector here, before;
};

// Factors of the waves inside: first X_{n-1} - second X_n.
struct InsidePair {
    ComplexVector first, second;

    MIEBRDF_VECTOR ComplexVector with(const WavePair& x) const {
        return first * x.before - second * x.here;
    }
};

// The pair of a_n, times m.
// @param slope  m - 1 / m
template <typename Number>
MIEBRDF_VECTOR InsidePair electric(Number m, Number slope, const WavePair& z,
                                   const Vector& n_over_x) {
    return {m * z.here, z.before + n_over_x * (slope * z.here)};
}

template <typename Number>
MIEBRDF_VECTOR InsidePair magnetic(Number m, const WavePair& z) {
    return {z.here, m * z.before};
}

// u + iv and u - iv
struct BothSigns {
    MIEBRDF_VECTOR BothSigns(const ComplexVector& u, const ComplexVector& v)
        : plus{u.re - v.im, u.im + v.re}, minus{u.re + v.im, u.im - v.re} {}
    ComplexVector plus, minus;
};

// G with the wave inside, and with its conjugate.
MIEBRDF_VECTOR BothSigns with_conjugate_inside(const InsidePair& z, const WavePair& x) {
    return {z.first.re * x.before - z.second.re * x.here,
            z.first.im * x.before - z.second.im * x.here};
}

// G with the wave outside, and with its conjugate.
MIEBRDF_VECTOR BothSigns with_conjugate_outside(const InsidePair& z, const WavePair& x) {
    return {x.before.re * z.first - x.here.re * z.second,
            x.before.im * z.first - x.here.im * z.second};
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

// Beyond the edge of a sphere that absorbs, the wave reflected inside may be larger than the one
// that comes: orders whose sum over ways diverges have all of it in the reflected ray.
MIEBRDF_VECTOR void join_divergent(RayResponse& response, int first) {
    constexpr double kLargest = 1 + 1e-9;  // rounding of transparent spheres stays below
    const ComplexVector inner = load(response.inner, first);
    const auto diverges = norm(inner) > Vector{} + kLargest;
    const ComplexVector outer = load(response.outer, first),
                        through = load(response.through, first);
    const ComplexVector all = outer + through * inverse(ComplexVector{1 - inner.re, -inner.im});
    const auto choose = [&](const ComplexVector& there, const ComplexVector& here, ComplexLanes& to)
        __attribute__((always_inline)) {
        store(diverges ? there.re : here.re, to.re, first);
        store(diverges ? there.im : here.im, to.im, first);
    };
    choose(all, outer, response.outer);
    choose({Vector{}, Vector{}}, through, response.through);
    choose({Vector{}, Vector{}}, inner, response.inner);
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
    const auto z = inside_parameter(m, x);
    inverse_z_ = reciprocal(z);
    // zeta_0 = -i exp(iz), zeta_{-1} = exp(iz), here without the factor.
    out_ = {{Lanes::Zero(), -Lanes::Ones()}, {Lanes::Ones(), Lanes::Zero()}};
    in_ = {{Lanes::Zero(), Lanes::Ones()}, {Lanes::Ones(), Lanes::Zero()}};
    const Lanes turns = 2 * real_part(z);
    round_ = {turns.cos(), turns.sin()};
    if constexpr (!std::is_same_v<Number, double>) {
        const Lanes damping = (-2 * z.im).exp();
        round_ = times(round_, damping);
        clear_ = (z.im > kOpaque).select(Lanes::Zero(), Lanes::Ones());
        if (clear_.minCoeff() < 1) {
            // Clear lanes, which may be much smaller, go along as the largest one.
            Eigen::Index largest;
            z.im.maxCoeff(&largest);
            auto opaque = z;
            opaque.re = (clear_ > 0).select(z.re[largest], z.re);
            opaque.im = (clear_ > 0).select(z.im[largest], z.im);
            regular_.emplace(opaque, number_of_terms(x.maxCoeff()));
        }
    }
}

template <typename Number>
void RayWaves<Number>::advance(const Lanes& last_order, RayResponse& a, RayResponse& b) {
    ++order_;
    if (regular_) regular_->advance();
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
    // Filled, not returned: returned waves would go through memory in halves.
    const auto step = [&](Wave & wave, WavePair & next) __attribute__((always_inline)) {
        next.before = load(wave.here, first);
        next.here = odd * (inverse_z * next.before) - load(wave.before, first);
        store(next.here, wave.here, first);
        store(next.before, wave.before, first);
    };
    WavePair out;
    step(out_, out);
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
    const InsidePair out_a = electric(m_, slope_, out, n_over_x), out_b = magnetic(m_, out);
    if constexpr (is_real) {
        const BothSigns of_a = with_conjugate_inside(out_a, x);
        const BothSigns of_b = with_conjugate_inside(out_b, x);
        respond(m_, of_a.minus, of_a.plus, conjugate(of_a.plus), round, a, first);
        respond(m_, of_b.minus, of_b.plus, conjugate(of_b.plus), round, b, first);
    } else {
        WavePair in;
        step(in_, in);
        if (regular_) {
            const auto is_clear = load(clear_, first) > Vector{};
            const auto choose = [&](ComplexVector & wave, const ComplexLanes& regular)
                __attribute__((always_inline)) {
                wave.re = is_clear ? wave.re : load(regular.re, first);
                wave.im = is_clear ? wave.im : load(regular.im, first);
            };
            choose(in.here, regular_->here());
            choose(in.before, regular_->before());
        }
        const BothSigns of_a = with_conjugate_outside(electric(m_, slope_, in, n_over_x), x);
        const BothSigns of_b = with_conjugate_outside(magnetic(m_, in), x);
        respond(m_, of_a.plus, out_a.with(x), of_a.minus, round, a, first);
        respond(m_, of_b.plus, out_b.with(x), of_b.minus, round, b, first);
        if (regular_) {
            const auto is_clear = load(clear_, first) > Vector{};
            for (ComplexLanes* z : {&a.inner, &a.through, &b.inner, &b.through}) {
                store(is_clear ? load(z->re, first) : Vector{}, z->re, first);
                store(is_clear ? load(z->im, first) : Vector{}, z->im, first);
            }
        }
        join_divergent(a, first);
        join_divergent(b, first);
    }
}

template class RayWaves<double>;
template class RayWaves<Complex>;

}  // namespace miebrdf::mie
