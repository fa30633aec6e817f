#include "mie/sphere/order_sums.h"

#include <cmath>
#include <cstring>

#include "mie/sphere/kept_memory.h"
#include "mie/sphere/order_segments.h"
#include "mie/sphere/radial_functions.h"

namespace miebrdf::mie {
namespace {

using Complex = std::complex<double>;

/// The same wave in all segments, from their upper ends downward.
class OutsideByRecurrence {
  public:
    OutsideByRecurrence(double x, const OutsideEnds& ends) : factor_({x, 0}), ends_(ends) {}

    struct Lane {
        MIEBRDF_VECTOR void descend(const Vector& odd) {  // 2n - 1
            const Vector f = factor.of(odd);
            const Vector next_psi = f * psi_before - psi, next_eta = f * eta_before - eta;
            psi = psi_before, eta = eta_before;
            psi_before = next_psi, eta_before = next_eta;
        }
        RealFactor factor;
        Vector psi, psi_before, eta, eta_before;
    };
    MIEBRDF_VECTOR Lane from(int lane) const {
        Lane start{factor_, {}, {}, {}, {}};
        for (int i = 0; i < kVectorSize; ++i) {
            start.psi[i] = ends_.psi[lane + i].here;
            start.psi_before[i] = ends_.psi[lane + i].before;
            start.eta[i] = ends_.eta[lane + i].here;
            start.eta_before[i] = ends_.eta[lane + i].before;
        }
        return start;
    }

  private:
    RealFactor factor_;
    const OutsideEnds& ends_;
};

/// Beyond n = x psi_n is computed downward, scaled to what it is at the first order, eta_n upward:
/// each where it grows. Both at once, since either waits for itself.
class OutsideFromMemory {
  public:
    OutsideFromMemory(double x, const Segments& segments, const Wave<double>& psi,
                      const Wave<double>& eta)
        : length_(segments.length), memory_(kLaneCount * (2 * length_ + 3)) {
        const RealFactor factor({x, 0});
        double* const psi_rows = memory_.data() + kLaneCount;
        double* const eta_rows = psi_rows + kLaneCount * (length_ + 1);
        // psi_{n+1} and psi_n at the last order, as if (2n + 1)/x were the same from there on. An
        // error of some per cent there is below rounding in a_n and b_n, and falls from order to
        // order as these rise.
        const double half = 0.5 * factor.of(2.0 * segments.end() + 1);
        double above = half - std::sqrt(half * half - 1), here = 1;
        double eta_before = eta.before, eta_here = eta.here;
        double odd_up = 2.0 * segments.first + 1, odd_down = 2.0 * segments.end() + 1;
        for (int lane = 0; lane < kLaneCount; ++lane) {
            double* to_psi = psi_rows + length_ * kLaneCount + kLaneCount - 1 - lane;
            double* to_eta = eta_rows + kLaneCount + lane;
            for (int i = 0; i < length_; ++i) {
                *to_psi = here;
                const double below = factor.of(odd_down) * here - above;
                above = here;
                here = below;
                const double next = factor.of(odd_up) * eta_here - eta_before;
                eta_before = eta_here;
                eta_here = next;
                *to_eta = eta_here;
                odd_down -= 2;
                odd_up += 2;
                to_psi -= kLaneCount;
                to_eta += kLaneCount;
            }
        }
        const double before = factor.of(odd_down) * here - above;
        const double scale =
            (psi.here * here + psi.before * before) / (here * here + before * before);
        for (double* p = psi_rows + kLaneCount; p < eta_rows; ++p) *p *= scale;
        psi_rows[0] = psi.here;
        eta_rows[0] = eta.here;
        for (int lane = 1; lane < kLaneCount; ++lane) {
            psi_rows[lane] = psi_rows[length_ * kLaneCount + lane - 1];
            eta_rows[lane] = eta_rows[length_ * kLaneCount + lane - 1];
        }
    }

    struct Lane {
        MIEBRDF_VECTOR void descend(const Vector&) {
            psi = psi_before, eta = eta_before;
            psi_row -= kLaneCount, eta_row -= kLaneCount;
            std::memcpy(&psi_before, psi_row, sizeof psi_before);
            std::memcpy(&eta_before, eta_row, sizeof eta_before);
        }
        const double *psi_row, *eta_row;
        Vector psi, psi_before, eta, eta_before;
    };
    MIEBRDF_VECTOR Lane from(int lane) const {
        const double* const end = memory_.data() + kLaneCount * (length_ + 1) + lane;
        Lane start{end, end + kLaneCount * (length_ + 1), {}, {}, {}, {}};
        std::memcpy(&start.psi_before, start.psi_row, sizeof(Vector));
        std::memcpy(&start.eta_before, start.eta_row, sizeof(Vector));
        start.descend(Vector{});
        return start;
    }

  private:
    int length_;
    KeptVector<double> memory_;  // rows of eight segments: a spare one, psi_n, eta_n
};

/// The wave inside, downward from the upper ends. Real: P = psi_n and Q = psi_{n-1}, in range.
template <typename Number>
struct InsideLane {
    template <bool in_range>
    MIEBRDF_VECTOR void descend(const RealFactor& factor, const Vector& odd, int left, double) {
        const Vector next = factor.of(odd) * Q - P;
        mP = m * Q;
        P = Q;
        Q = next;
        if (in_range || left % 8 != 0) return;
        const Vector g = 1 / (magnitude(P) + magnitude(Q));
        P *= g;
        Q *= g;
        mP *= g;
    }
    double m;
    Vector P, Q, mP;
};

// Complex: only their ratio, and with it T: one real division, and no care for their range.
template <>
struct InsideLane<Complex> {
    template <bool in_range>
    MIEBRDF_VECTOR void descend(const ComplexFactor& factor, const Vector& odd, int, double slope) {
        const Vector inverse_norm = 1 / norm(Q);
        const ComplexVector f = factor.of(odd);
        Q = {f.re - Q.re * inverse_norm, f.im + Q.im * inverse_norm};
        T = T * inverse_norm - odd * slope;
    }
    ComplexVector Q;  // P = 1
    Vector T;
};

template <typename Number>
MIEBRDF_VECTOR InsideLane<Number> inside_from(const EndWaves<Number>& ends, int lane, Number m) {
    InsideLane<Number> start{};
    for (int i = 0; i < kVectorSize; ++i) {
        const Wave<Number>& end = ends[lane + i];
        if constexpr (kReal<Number>) {
            start.m = m;
            start.P[i] = end.here;
            start.Q[i] = end.before;
            start.mP[i] = m * end.here;
        } else {
            const double inverse_norm = 1 / std::norm(end.here);
            const Complex ratio = product(end.before, std::conj(end.here)) * inverse_norm;
            start.Q.re[i] = ratio.real();
            start.Q.im[i] = ratio.imag();
            start.T[i] = end.T * inverse_norm;
        }
    }
    return start;
}

/// a_n and b_n, and (Re a_n - |a_n|^2) + (Re b_n - |b_n|^2).
struct Responses {
    ComplexVector a, b;
    Vector absorbed;
};

template <typename Number>
struct SphereBoundary;

// Symbols of Boundary.
template <>
struct SphereBoundary<double> {
    SphereBoundary(double m, double x) : slope_((m - 1 / m) / x) {}

    template <typename Outside>
    MIEBRDF_VECTOR Responses scatter(const Vector& n, const InsideLane<double>& inside,
                                     const Outside& outside) const {
        const Vector &P = inside.P, &Q = inside.Q, &mP = inside.mP;
        const Vector B = inside.m * Q, A = Q + (n * slope_) * P;
        const Vector pa = A * outside.psi - mP * outside.psi_before;
        const Vector qa = A * outside.eta - mP * outside.eta_before;
        const Vector pb = B * outside.psi - P * outside.psi_before;
        const Vector qb = B * outside.eta - P * outside.eta_before;
        const Vector norm_a = pa * pa + qa * qa, norm_b = pb * pb + qb * qb;
        const Vector shared = 1 / (norm_a * norm_b);
        const Vector factor_a = pa * (norm_b * shared), factor_b = pb * (norm_a * shared);
        return {{pa * factor_a, -qa * factor_a}, {pb * factor_b, -qb * factor_b}, Vector{}};
    }

    double slope_;
};

template <>
struct SphereBoundary<Complex> {
    SphereBoundary(Complex m, double x)
        : m_(m), slope_((m - 1.0 / m) / x), cross_(2 * m.real() * m.imag() / std::norm(m) / x) {}

    template <typename Outside>
    MIEBRDF_VECTOR Responses scatter(const Vector& n, const InsideLane<Complex>& inside,
                                     const Outside& outside) const {
        const double re = m_.real(), im = m_.imag();
        const ComplexVector& Q = inside.Q;
        const ComplexVector A{Q.re + n * slope_.real(), Q.im + n * slope_.imag()};
        const ComplexVector B{re * Q.re - im * Q.im, re * Q.im + im * Q.re};
        const Vector &psi = outside.psi, &psi_before = outside.psi_before;
        const Vector &eta = outside.eta, &eta_before = outside.eta_before;
        const ComplexVector pa{A.re * psi - re * psi_before, A.im * psi - im * psi_before};
        const ComplexVector pb{B.re * psi - psi_before, B.im * psi};
        // p + i q
        const ComplexVector da{pa.re - A.im * eta + im * eta_before,
                               pa.im + A.re * eta - re * eta_before};
        const ComplexVector db{pb.re - B.im * eta, pb.im + B.re * eta - eta_before};
        const Vector norm_a = norm(da), norm_b = norm(db);
        const Vector shared = 1 / (norm_a * norm_b);
        const Vector inverse_a = norm_b * shared, inverse_b = norm_a * shared;
        const Vector in_phase = im * Q.re;
        const Vector electric = re * inside.T - in_phase + cross_ * n;
        const Vector magnetic = re * inside.T + in_phase;
        return {{(pa.re * da.re + pa.im * da.im) * inverse_a,
                 (pa.im * da.re - pa.re * da.im) * inverse_a},
                {(pb.re * db.re + pb.im * db.im) * inverse_b,
                 (pb.im * db.re - pb.re * db.im) * inverse_b},
                -(electric * inverse_a + magnetic * inverse_b)};
    }

    Complex m_, slope_;
    double cross_;
};

/// Coefficients at both ends of a segment: neighbours' products reach across them.
struct EdgeOrders {
    Complex a, b;
};
struct SegmentEdges {
    std::array<EdgeOrders, kLaneCount> lowest, highest;
};

MIEBRDF_VECTOR Vector dot(const ComplexVector& u, const ComplexVector& v) {
    return u.re * v.re + u.im * v.im;
}
double dot(Complex u, Complex v) { return u.real() * v.real() + u.imag() * v.imag(); }

MIEBRDF_VECTOR void put_edges(const Responses& responses, int lane,
                              std::array<EdgeOrders, kLaneCount>& to) {
    for (int i = 0; i < kVectorSize; ++i) {
        to[lane + i] = {{responses.a.re[i], responses.a.im[i]},
                        {responses.b.re[i], responses.b.im[i]}};
    }
}

double sum_of(const Vector& v) {
    double sum = 0;
    for (int i = 0; i < kVectorSize; ++i) sum += v[i];
    return sum;
}

// Second pass. With X_n = Re(a_n a*_{n-1} + b_n b*_{n-1}) and Y_n = Re a_n b*_n, the asymmetry is
// the sum over n of n X_n + (Y_n + Y_{n-1} - X_n) / n (Bohren & Huffman 1983, sect. 4.5).
template <typename Number, bool in_range, typename Outside>
[[gnu::noinline]] SegmentEdges add_segments(const Segments& segments, Number m, double x,
                                            const EndWaves<Number>& inside_ends,
                                            const Outside& outside_ends, OrderSums& sums) {
    const SphereBoundary<Number> boundary(m, x);
    const auto z = inside_parameter(m, x);
    const Factor<Number> factor(z);
    const double slope = std::imag(z.value) / std::norm(z.value);
    SegmentEdges edges;
    for (int lane = 0; lane < kLaneCount; lane += kVectorSize) {
        auto outside = outside_ends.from(lane);
        auto inside = inside_from<Number>(inside_ends, lane, m);
        Vector n = segments.bottoms(lane) + segments.length;
        Vector extinguished{}, absorbed{}, asymmetric{}, back_re{}, back_im{};
        Responses above{};
        Vector Y_above{};
        const auto add_order = [&](int left, bool is_even) __attribute__((always_inline)) {
            const Responses here = boundary.scatter(n, inside, outside);
            const Vector weight = 2 * n + 1, next = n + 1;
            const Vector X = dot(here.a, above.a) + dot(here.b, above.b);
            const Vector Y = dot(here.a, here.b);
            asymmetric += next * X + (Y + Y_above - X) / next;
            extinguished += weight * (here.a.re + here.b.re);
            if constexpr (!kReal<Number>) absorbed += weight * here.absorbed;
            if (is_even) {
                back_re += weight * (here.a.re - here.b.re);
                back_im += weight * (here.a.im - here.b.im);
            } else {
                back_re -= weight * (here.a.re - here.b.re);
                back_im -= weight * (here.a.im - here.b.im);
            }
            if (left == segments.length) put_edges(here, lane, edges.highest);
            above = here;
            Y_above = Y;
            const Vector odd = weight - 2;
            outside.descend(odd);
            inside.template descend<in_range>(factor, odd, left, slope);
            n -= 1;
        };
        // Two orders at a time: nothing changes places, which takes registers.
        int left = segments.length;
        const double first_sign = left % 2 == 0 ? 1.0 : -1.0;
        if (left % 2 == 1) add_order(left--, false);
        for (; left > 0; left -= 2) {
            add_order(left, true);
            add_order(left - 1, false);
        }
        put_edges(above, lane, edges.lowest);
        sums.scattered += sum_of(extinguished - absorbed);
        sums.absorbed += sum_of(absorbed);
        sums.asymmetric += sum_of(asymmetric);
        Vector parity;  // (-1)^n of the first order
        for (int i = 0; i < kVectorSize; ++i)
            parity[i] = (segments.first + (lane + i + 1) * segments.length) % 2 == 0 ? 1 : -1;
        parity *= first_sign;
        sums.back += Complex(sum_of(parity * back_re), sum_of(parity * back_im));
    }
    return edges;
}

// What the asymmetry has of the lowest order of a segment and the highest one of that below.
double across(int n, const EdgeOrders& lowest, const EdgeOrders& below) {
    const double X = dot(lowest.a, below.a) + dot(lowest.b, below.b);
    return n * X + (dot(lowest.a, lowest.b) - X) / n;
}

void add_across(const Segments& segments, const SegmentEdges& edges, EdgeOrders below,
                OrderSums& sums) {
    for (int lane = 0; lane < kLaneCount; ++lane) {
        sums.asymmetric +=
            across(segments.first + lane * segments.length + 1, edges.lowest[lane], below);
        below = edges.highest[lane];
    }
}

}  // namespace

template <typename Number>
OrderSums sum_orders_by_segments(Number m, double x) {
    // Below n = x the waves outside oscillate; beyond, they are taken from memory.
    const Segments lower{0, static_cast<int>(x) / kLaneCount};
    const Segments upper{lower.end(),
                         (number_of_terms(x) - lower.end() + kLaneCount - 1) / kLaneCount};
    const OutsideEnds outside = outside_ends(lower, x);
    const OutsideFromMemory outside_beyond(x, upper, outside.psi.back(), outside.eta.back());
    const auto z = inside_parameter(m, x);
    const bool upward = upward_is_stable(z.value, upper.end());
    const InsideEnds<Number> inside = inside_ends(lower, upper, z, upward);
    OrderSums sums;
    const auto add = [&]<bool in_range>(std::bool_constant<in_range>) {
        const OutsideByRecurrence outside_below(x, outside);
        const SegmentEdges beyond =
            add_segments<Number, in_range>(upper, m, x, inside.upper, outside_beyond, sums);
        const SegmentEdges below =
            add_segments<Number, in_range>(lower, m, x, inside.lower, outside_below, sums);
        add_across(upper, beyond, below.highest.back(), sums);
        add_across(lower, below, {}, sums);
    };
    if (upward || !kReal<Number>) {
        add(std::true_type{});
    } else {
        add(std::false_type{});
    }
    return sums;
}

template OrderSums sum_orders_by_segments(double, double);
template OrderSums sum_orders_by_segments(std::complex<double>, double);

}  // namespace miebrdf::mie
