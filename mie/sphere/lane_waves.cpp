#include "mie/sphere/lane_waves.h"

#include <algorithm>
#include <optional>

#include "mie/sphere/radial_functions.h"

namespace miebrdf::mie {
namespace {

using Complex = std::complex<double>;

double lane_of(const Lanes& z, int lane) { return z[lane]; }
Complex lane_of(const ComplexLanes& z, int lane) { return {z.re[lane], z.im[lane]}; }

void set_lane(Lanes& lanes, int lane, double value) { lanes[lane] = value; }
void set_lane(ComplexLanes& lanes, int lane, Complex value) {
    lanes.re[lane] = value.real();
    lanes.im[lane] = value.imag();
}

Lanes modulus_bound(const Lanes& z) { return z.abs(); }
Lanes modulus_bound(const ComplexLanes& z) { return z.re.abs() + z.im.abs(); }

// Ratio psi_{n-1} / psi_n at the highest order, when the far side cannot be seen (see
// damped_logarithmic_derivative); empty if that does not hold for every lane.
std::optional<ComplexLanes> far_above_start(const ComplexLanes& all_z, int order) {
    ComplexLanes ratio;
    for (int lane = 0; lane < kLaneCount; ++lane) {
        const Complex z = lane_of(all_z, lane);
        const auto D = damped_logarithmic_derivative(z, order);
        if (!D) return std::nullopt;
        set_lane(ratio, lane, *D + static_cast<double>(order) / z);
    }
    return ratio;
}

// The compiler's complex products guard against infinities that cannot occur here.
double product(double a, double b) { return a * b; }
Complex product(Complex a, Complex b) {
    return {a.real() * b.real() - a.imag() * b.imag(), a.real() * b.imag() + a.imag() * b.real()};
}

double modulus_bound(double z) { return std::abs(z); }
double modulus_bound(Complex z) { return std::abs(z.real()) + std::abs(z.imag()); }

int whole_vectors(int terms) { return (terms + kLaneCount - 1) / kLaneCount * kLaneCount + 1; }

}  // namespace

template <typename Number>
InsideWave<Number>::InsideWave(const Values& z, int terms) : inverse_z_(reciprocal(z)) {
    double damping = 0;
    if constexpr (!std::is_same_v<Number, double>) damping = z.im.maxCoeff();
    upward_ = upward_is_stable({real_part(z).minCoeff(), damping}, terms);
    if (upward_) {
        start_upward(z);
    } else {
        run_downward(z, terms);
    }
}

template <typename Number>
void InsideWave<Number>::start_upward(const Values& z) {
    for (int lane = 0; lane < kLaneCount; ++lane) {
        set_lane(here_, lane, std::sin(lane_of(z, lane)));
        set_lane(before_, lane, std::cos(lane_of(z, lane)));
    }
}

template <typename Number>
void InsideWave<Number>::run_downward(const Values& z, int terms) {
    const double modulus = std::sqrt(norm(z).maxCoeff());
    stored_.resize(terms + 1);
    int start = safe_start(modulus, terms);
    Values above, current;  // psi_{n+1}, psi_n
    for (int lane = 0; lane < kLaneCount; ++lane) {
        set_lane(above, lane, 0.0);
        set_lane(current, lane, 1.0);
    }
    if constexpr (!std::is_same_v<Number, double>) {
        if (const auto ratio = far_above_start(z, terms + 1)) {
            start = terms;
            current = *ratio;  // psi_terms, with psi_{terms+1} = 1
            for (int lane = 0; lane < kLaneCount; ++lane) set_lane(above, lane, 1.0);
        }
    }
    constexpr bool absorbing = !std::is_same_v<Number, double>;
    Lanes slope, T;  // AbsorptionSource
    if constexpr (absorbing) {
        absorption_.resize(terms + 1);
        slope = z.im * norm(inverse_z_);
        T = current.im * above.re - current.re * above.im;
    }
    for (int n = start; n >= 1; --n) {
        if (n <= terms) stored_[n] = current;
        if constexpr (absorbing) T -= (2 * n + 1) * slope * norm(current);
        const Values below = minus(times(scaled(inverse_z_, 2 * n + 1), current), above);
        above = current;
        current = below;
        // Eight steps of growth by 2n/|z| each stay far from overflow, also squared twice.
        if (n % 8 == 0) {
            const Lanes size = modulus_bound(current) + modulus_bound(above);
            if (size.maxCoeff() > 1e12) {
                const Lanes factor = 1 / size;
                current = times(current, factor);
                above = times(above, factor);
                if constexpr (absorbing) T *= factor.square();
                if (n <= terms) factors_.push_back({n, factor});
            }
        }
        if constexpr (absorbing) {
            if (n <= terms) absorption_[n] = T;
        }
    }
    stored_[0] = current;
    std::reverse(factors_.begin(), factors_.end());
}

template class InsideWave<double>;
template class InsideWave<Complex>;

// Filled up with ones: their a_n and b_n are finite, and cut off by psi_n(x) = 0.
template <typename Number>
void InsideOrders<Number>::Parts::make_room(int terms) {
    re.assign(whole_vectors(terms), 1.0);
    if constexpr (!std::is_same_v<Number, double>) im.assign(re.size(), 0.0);
}

template <typename Number>
void InsideOrders<Number>::Parts::set(int n, Number value) {
    re[n] = std::real(value);
    if constexpr (!std::is_same_v<Number, double>) im[n] = value.imag();
}

template <typename Number>
InsideOrders<Number> InsideOrders<Number>::upward(Number z, int terms) {
    InsideOrders orders;
    orders.here_.make_room(terms);
    const Number inverse = 1.0 / z;
    Number before = std::cos(z), here = std::sin(z);
    orders.here_.set(0, here);
    for (int n = 1; n <= terms; ++n) {
        const Number next = product((2.0 * n - 1) * inverse, here) - before;
        before = here;
        here = next;
        orders.here_.set(n, here);
    }
    if constexpr (!std::is_same_v<Number, double>) orders.sum_absorption_upward(z, terms);
    return orders;
}

template <typename Number>
void InsideOrders<Number>::sum_absorption_upward(Complex z, int terms) {
    const KeptVector<double>&re = here_.re, &im = here_.im;
    absorption_.assign(re.size(), 0.0);
    if (z.imag() >= 1) {
        for (int n = 1; n <= terms; ++n) {
            absorption_[n] = im[n - 1] * re[n] - re[n - 1] * im[n];
        }
        return;
    }
    const double slope = z.imag() / std::norm(z);
    absorption_[0] = -0.5 * std::sinh(2 * z.imag());
    for (int n = 0; n < terms; ++n) {
        absorption_[n + 1] = absorption_[n] + (2 * n + 1) * slope * (re[n] * re[n] + im[n] * im[n]);
    }
}

template <typename Number>
InsideOrders<Number> InsideOrders<Number>::of_upward(KeptVector<double> psi, int terms) {
    InsideOrders orders;
    psi.resize(whole_vectors(terms));
    std::fill(psi.begin() + terms + 1, psi.end(), 1.0);
    orders.here_.re = std::move(psi);
    return orders;
}

template <typename Number>
void InsideOrders<Number>::put(int n, Number value, double absorption) {
    here_.set(n, value);
    if constexpr (!std::is_same_v<Number, double>) absorption_[n] = absorption;
}

template <typename Number>
InsideOrders<Number> InsideOrders<Number>::downward(Number z, int terms) {
    InsideOrders orders;
    orders.here_.make_room(terms);
    orders.before_.make_room(terms);
    const int top = whole_vectors(terms) - 1;
    int start = whole_vectors(safe_start(std::abs(z), terms)) - 1;
    Number above = 0.0, here = 1.0;  // psi_{n+1}, psi_n
    if constexpr (!std::is_same_v<Number, double>) {
        if (const auto D = damped_logarithmic_derivative(z, top + 1)) {
            start = top;
            above = 1.0;
            here = *D + (top + 1.0) / z;
        }
    }
    constexpr bool absorbing = !std::is_same_v<Number, double>;
    double slope = 0, T = 0;
    if constexpr (absorbing) {
        orders.absorption_.resize(top + 1);
        slope = z.imag() / std::norm(z);
        T = here.imag() * above.real() - here.real() * above.imag();
    }
    const Number inverse = 1.0 / z;
    for (int last = start; last > 0; last -= kLaneCount) {
        const bool kept = last <= top;
        // Two orders at a time, as in radial_functions.cpp.
        for (int n = last; n > last - kLaneCount; n -= 2) {
            if constexpr (absorbing) T -= (2 * n + 1) * slope * std::norm(here);
            if (kept) orders.put(n, here, T);
            above = product((2.0 * n + 1) * inverse, here) - above;  // psi_{n-1}
            if constexpr (absorbing) T -= (2 * n - 1) * slope * std::norm(above);
            if (kept) {
                orders.before_.set(n, above);
                orders.put(n - 1, above, T);
            }
            here = product((2.0 * n - 1) * inverse, above) - here;  // psi_{n-2}
            if (kept) orders.before_.set(n - 1, here);
        }
        // Eight steps of growth by 2n/|z| each stay far from overflow, also squared twice.
        const double size = modulus_bound(here) + modulus_bound(above);
        if (!(size > 1e12)) continue;
        const double factor = 1 / size;
        here *= factor;
        above *= factor;
        T *= factor * factor;
    }
    return orders;
}

template class InsideOrders<double>;
template class InsideOrders<Complex>;

}  // namespace miebrdf::mie
