#include "mie/sphere/inside_wave.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "mie/sphere/logarithmic_derivative.h"

namespace miebrdf::mie {
namespace {

using Complex = std::complex<double>;

Lanes reciprocal(const Lanes& z) { return 1 / z; }
ComplexLanes reciprocal(const ComplexLanes& z) {
    const Lanes inverse_norm = 1 / norm(z);
    return {z.re * inverse_norm, -z.im * inverse_norm};
}

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
// logarithmic_derivative.h); empty if that does not hold for every lane.
std::optional<ComplexLanes> far_above_start(const ComplexLanes& all_z, int order) {
    ComplexLanes ratio;
    for (int lane = 0; lane < lane_count; ++lane) {
        const Complex z = lane_of(all_z, lane);
        const auto D = damped_logarithmic_derivative(z, order);
        if (!D) return std::nullopt;
        set_lane(ratio, lane, *D + static_cast<double>(order) / z);
    }
    return ratio;
}

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
    for (int lane = 0; lane < lane_count; ++lane) {
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
    for (int lane = 0; lane < lane_count; ++lane) {
        set_lane(above, lane, 0.0);
        set_lane(current, lane, 1.0);
    }
    if constexpr (!std::is_same_v<Number, double>) {
        if (const auto ratio = far_above_start(z, terms + 1)) {
            start = terms;
            current = *ratio;  // psi_terms, with psi_{terms+1} = 1
            for (int lane = 0; lane < lane_count; ++lane) set_lane(above, lane, 1.0);
        }
    }
    constexpr bool absorbing = !std::is_same_v<Number, double>;
    Lanes slope, T;  // absorption_source.h
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

}  // namespace miebrdf::mie
