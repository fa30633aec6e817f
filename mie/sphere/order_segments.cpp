#include "mie/sphere/order_segments.h"

#include <optional>

#include "mie/sphere/radial_functions.h"

namespace miebrdf::mie {
namespace {

using Complex = std::complex<double>;

// a b - c, two multiply-adds for each part.
MIEBRDF_VECTOR Vector multiply_subtract(const Vector& a, const Vector& b, const Vector& c) {
    return a * b - c;
}
MIEBRDF_VECTOR ComplexVector multiply_subtract(const ComplexVector& a, const ComplexVector& b,
                                               const ComplexVector& c) {
    return {a.re * b.re - c.re - a.im * b.im, a.re * b.im - c.im + a.im * b.re};
}
// a b + c d
MIEBRDF_VECTOR Complex combine(Complex a, Complex b, Complex c, Complex d) {
    return product(a, b) + product(c, d);
}
MIEBRDF_VECTOR double combine(double a, double b, double c, double d) { return a * b + c * d; }

double lane_of(const Lanes& z, int lane) { return z[lane]; }
Complex lane_of(const ComplexLanes& z, int lane) { return {z.re[lane], z.im[lane]}; }

/// From one end of each segment to the other: what the solutions (1, 0) and (0, 1) have become.
template <typename Number>
struct Transfer {
    LanesOf<Number> u_here, u_before, v_here, v_before;
    // Sums of (2n - 1) times |u|^2, |v|^2 and u v* of order n - 1, and all factors that keep the
    // solutions in range.
    Lanes uu, vv, uv_re, uv_im, scale;

    Wave<Number> apply(int lane, const Wave<Number>& w, double slope) const {
        Wave<Number> next{
            combine(w.here, lane_of(u_here, lane), w.before, lane_of(v_here, lane)),
            combine(w.here, lane_of(u_before, lane), w.before, lane_of(v_before, lane))};
        if constexpr (!kReal<Number>) {
            const Complex across = product(w.here, std::conj(w.before));
            next.T = w.T * scale[lane] * scale[lane] +
                     slope * (std::norm(w.here) * uu[lane] + std::norm(w.before) * vv[lane] +
                              2 * (across.real() * uv_re[lane] - across.imag() * uv_im[lane]));
        }
        return next;
    }
};

enum class Way { kUp, kDown };

/// The two solutions in some of the segments.
template <typename Number, Way way, bool summed>
struct SolutionPair {
    using V = VectorOf<Number>;
    static constexpr bool up = way == Way::kUp;

    MIEBRDF_VECTOR void start(const Segments& segments, int first_lane) {
        if constexpr (kReal<Number>) {
            u_here += 1;
            v_before += 1;
        } else {
            u_here.re += 1;
            v_before.re += 1;
        }
        odd = 2 * segments.bottoms(first_lane) + (up ? 1 : 2 * segments.length - 1);
    }

    /// Two orders: nothing changes places, which takes registers.
    MIEBRDF_VECTOR void step_twice(const Factor<Number>& factor) {
        if constexpr (up) {
            step(factor, u_here, v_here, u_before, v_before);
            step(factor, u_before, v_before, u_here, v_here);
        } else {
            step(factor, u_before, v_before, u_here, v_here);
            step(factor, u_here, v_here, u_before, v_before);
        }
    }
    MIEBRDF_VECTOR void step_once(const Factor<Number>& factor) {
        if constexpr (up) {
            step(factor, u_here, v_here, u_before, v_before);
        } else {
            step(factor, u_before, v_before, u_here, v_here);
        }
        std::swap(u_here, u_before);
        std::swap(v_here, v_before);
    }

    MIEBRDF_VECTOR void rescale() {
        const Vector g =
            1 / (bound_of(u_here) + bound_of(u_before) + bound_of(v_here) + bound_of(v_before));
        u_here = g * u_here, u_before = g * u_before;
        v_here = g * v_here, v_before = g * v_before;
        if constexpr (summed) {
            scale *= g;
            uu *= g * g, vv *= g * g, uv_re *= g * g, uv_im *= g * g;
        }
    }

    MIEBRDF_VECTOR void put(Transfer<Number>& to, int lane) const {
        store(u_here, to.u_here, lane);
        store(u_before, to.u_before, lane);
        store(v_here, to.v_here, lane);
        store(v_before, to.v_before, lane);
        store(uu, to.uu, lane);
        store(vv, to.vv, lane);
        store(uv_re, to.uv_re, lane);
        store(uv_im, to.uv_im, lane);
        store(scale, to.scale, lane);
    }

    /// From the last order to the next one, in place of that behind.
    MIEBRDF_VECTOR void step(const Factor<Number>& factor, const V& u, const V& v, V& u_behind,
                             V& v_behind) {
        const V f = factor.of(odd);
        add(u, v);
        u_behind = multiply_subtract(f, u, u_behind);
        v_behind = multiply_subtract(f, v, v_behind);
        odd += up ? 2.0 : -2.0;
    }

    MIEBRDF_VECTOR void add(const V& u, const V& v) {
        if constexpr (summed) {
            uu += odd * norm(u);
            vv += odd * norm(v);
            uv_re += odd * (u.re * v.re + u.im * v.im);
            uv_im += odd * (u.im * v.re - u.re * v.im);
        }
    }

    V u_here{}, u_before{}, v_here{}, v_before{};
    Vector odd;  // 2n - 1
    Vector uu{}, vv{}, uv_re{}, uv_im{}, scale = Vector{} + 1;
};

template <typename Number, Way way, bool summed>
[[gnu::noinline]] Transfer<Number> transfer(const Segments& segments,
                                            const Factor<Number>& factor) {
    // Each step waits for the one before: two lots of segments at once where registers hold them.
    constexpr int together = kReal<Number> && kVectorSize < kLaneCount ? 2 : 1;
    // From step to step a solution grows by (2n + 1)/|z| and 1 at most.
    const int rescaling = 2 * segments.end() * factor.bound() < 3 ? 32 : 8;
    Transfer<Number> result;
    for (int lane = 0; lane < kLaneCount; lane += together * kVectorSize) {
        SolutionPair<Number, way, summed> one, other;  // not in a list, which would be in memory
        one.start(segments, lane);
        if constexpr (together == 2) other.start(segments, lane + kVectorSize);
        int left = segments.length;
        if (left % 2 == 1) {
            one.step_once(factor);
            if constexpr (together == 2) other.step_once(factor);
            --left;
        }
        for (; left > 0; left -= 2) {
            one.step_twice(factor);
            if constexpr (together == 2) other.step_twice(factor);
            if (way == Way::kUp || left % rescaling != 2) continue;
            one.rescale();
            if constexpr (together == 2) other.rescale();
        }
        one.put(result, lane);
        if constexpr (together == 2) other.put(result, lane + kVectorSize);
    }
    return result;
}

// Upward from the lower end of the first segment.
template <typename Number, bool summed>
EndWaves<Number> ends_upward(const Segments& segments, const Factor<Number>& factor,
                             Wave<Number> wave, double slope) {
    const auto T = transfer<Number, Way::kUp, summed>(segments, factor);
    EndWaves<Number> ends;
    for (int lane = 0; lane < kLaneCount; ++lane) ends[lane] = wave = T.apply(lane, wave, slope);
    return ends;
}

// Downward from the upper end of the last one; `wave` becomes that of its lower end.
template <typename Number, bool summed>
EndWaves<Number> ends_downward(const Segments& segments, const Factor<Number>& factor,
                               Wave<Number>& wave, double slope) {
    const auto T = transfer<Number, Way::kDown, summed>(segments, factor);
    EndWaves<Number> ends;
    for (int lane = kLaneCount - 1; lane >= 0; --lane) {
        ends[lane] = wave;
        wave = T.apply(lane, wave, -slope);
    }
    wave.normalise();
    return ends;
}

// The product Im(psi_{n-1} psi_n*) has lost more than two digits.
bool hides_absorption(const Wave<Complex>& wave) {
    return !(std::abs(product(wave.before, std::conj(wave.here)).imag()) >=
             0.01 * bound_of(wave.before) * bound_of(wave.here));
}

// By the WKB expansion, where no wave comes back from the far side: that of damped waves.
std::optional<Wave<Complex>> damped_wave(Complex z, int order) {
    const auto D = damped_logarithmic_derivative(z, order);
    if (!D) return std::nullopt;
    const Complex ratio = *D + static_cast<double>(order) / z;
    return Wave<Complex>{1.0, ratio, ratio.imag()};
}
std::optional<Wave<double>> damped_wave(double, int) { return std::nullopt; }

// Each end by itself takes as long as this many steps of all segments.
constexpr int kLeastDampedLength = 60;

template <typename Number>
bool all_damped(const Segments& segments, Number z, EndWaves<Number>& ends) {
    if (segments.length < kLeastDampedLength) return false;
    // The highest one is damped least.
    for (int lane = kLaneCount - 1; lane >= 0; --lane) {
        const auto wave = damped_wave(z, segments.first + (lane + 1) * segments.length);
        if (!wave) return false;
        ends[lane] = *wave;
    }
    return true;
}

template <typename Number, bool summed>
InsideEnds<Number> ends_inside(const Segments& lower, const Segments& upper,
                               const Parameter<Number>& parameter, bool upward) {
    const Number z = parameter.value;
    const Factor<Number> factor(parameter);
    const double slope = std::imag(z) / std::norm(z);
    InsideEnds<Number> ends;
    if (upward) {
        Wave<Number> wave = parameter.order_zero();
        wave.T = -0.5 * std::sinh(2 * std::imag(z));
        ends.lower = ends_upward<Number, summed>(lower, factor, wave, slope);
        ends.upper = ends_upward<Number, summed>(upper, factor, ends.lower.back(), slope);
    } else {
        Wave<Number> wave{0.0, 1.0};
        if (const auto damped = damped_wave(z, upper.end())) {
            wave = *damped;
        } else {
            const int steps = safe_start(std::abs(z), upper.end()) - upper.end();
            const Segments far{upper.end(), (steps + kLaneCount - 1) / kLaneCount};
            ends_downward<Number, summed>(far, factor, wave, slope);
        }
        ends.upper = ends_downward<Number, summed>(upper, factor, wave, slope);
        if (summed || !all_damped(lower, z, ends.lower)) {
            ends.lower = ends_downward<Number, summed>(lower, factor, wave, slope);
        }
    }
    if constexpr (!kReal<Number> && !summed) {
        for (EndWaves<Number>* all : {&ends.lower, &ends.upper}) {
            for (Wave<Number>& wave : *all) {
                if (hides_absorption(wave)) {
                    return ends_inside<Number, true>(lower, upper, parameter, upward);
                }
                wave.T = product(wave.before, std::conj(wave.here)).imag();
            }
        }
    }
    return ends;
}

}  // namespace

OutsideEnds outside_ends(const Segments& segments, double x) {
    const auto T = transfer<double, Way::kUp, false>(segments, RealFactor({x, 0}));
    Wave<double> psi = Parameter<double>{x, 0}.order_zero(), eta{-psi.before, psi.here};
    OutsideEnds ends;
    for (int lane = 0; lane < kLaneCount; ++lane) {
        ends.psi[lane] = psi = T.apply(lane, psi, 0);
        ends.eta[lane] = eta = T.apply(lane, eta, 0);
    }
    return ends;
}

template <typename Number>
InsideEnds<Number> inside_ends(const Segments& lower, const Segments& upper,
                               const Parameter<Number>& z, bool upward) {
    if constexpr (!kReal<Number>) {
        // As AbsorptionSource: what is little damped has to be summed.
        if (z.value.imag() < 1) return ends_inside<Number, true>(lower, upper, z, upward);
    }
    return ends_inside<Number, false>(lower, upper, z, upward);
}

template InsideEnds<double> inside_ends(const Segments&, const Segments&, const Parameter<double>&,
                                        bool);
template InsideEnds<Complex> inside_ends(const Segments&, const Segments&,
                                         const Parameter<Complex>&, bool);

}  // namespace miebrdf::mie
