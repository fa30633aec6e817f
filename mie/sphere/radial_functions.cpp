#include "mie/sphere/radial_functions.h"

#include <algorithm>
#include <cmath>

#include "mie/sphere/lanes.h"
#include "mie/sphere/terms.h"

namespace miebrdf::mie {
namespace {

// (2n - 1)/z, n = 0 ... highest_order: divided, not times 1/z, which would be another z, by a
// rounding, for all orders; and all at once, because divisions one by one cost more than the rest.
std::vector<double> recurrence_factors(double z, int highest_order) {
    std::vector<double> factors(highest_order + lane_count);
    Lanes odd = Lanes::LinSpaced(lane_count, -1, 2 * lane_count - 3);
    for (int n = 0; n <= highest_order; n += lane_count, odd += 2 * lane_count) {
        Eigen::Map<Lanes> eight(factors.data() + n);
        eight = odd / z;
    }
    return factors;
}

// f_n = (2n - 1)/z f_{n-1} - f_{n-2}, two orders at a time: neither value is ever copied, which
// would cost as much as the multiply-add.
struct UpwardRecurrence {
    void next_two(const double* factors, double* values) {
        before = factors[0] * here - before;
        values[0] = before;
        here = factors[1] * before - here;
        values[1] = here;
    }
    double before, here;
};

// psi_n, n = turn + 1 ... highest_order, from psi_turn: downward, where it grows.
void continue_beyond_turn(std::vector<double>& psi, int turn, double x) {
    const int highest_order = static_cast<int>(psi.size()) - 1;
    const int start = highest_order + static_cast<int>(2 * std::cbrt(x)) + 15;
    if (x < 2) {  // (2n/x)^n might overflow: by ratios, with E_n(x) of logarithmic_derivative.h
        double E = 0;
        for (int n = start; n > turn; --n) {
            E = -x * x / (2 * n + 3 + E);
            if (n <= highest_order) psi[n] = x / (2 * n + 1 + E);
        }
        for (int n = turn + 1; n <= highest_order; ++n) psi[n] *= psi[n - 1];
        return;
    }
    const double inverse = 1 / x;
    double above = 0, here = 1e-200;
    for (int n = start; n > turn; --n) {
        if (n <= highest_order) psi[n] = here;
        const double below = (2 * n + 1) * inverse * here - above;
        above = here;
        here = below;
    }
    const double scale = psi[turn] / here;  // no zero there: the first is 1.8 n^(1/3) above n
    for (int n = turn + 1; n <= highest_order; ++n) psi[n] *= scale;
}

}  // namespace

int number_of_terms(double size_parameter) {
    // Below x = 0.001 each term is 10^-6 of the one before; fewer keep eta_n ~ x^-n from overflow.
    if (size_parameter < 1e-3) return 6;
    return static_cast<int>(size_parameter + 8 * std::cbrt(size_parameter) + 12);
}

RadialFunctions radial_functions(double size_parameter, int highest_order, double* inside,
                                 double inside_parameter) {
    const double x = size_parameter;
    RadialFunctions radial;
    std::vector<double>& psi = radial.psi;
    std::vector<double>& eta = radial.eta;
    for (auto* values : {&psi, &eta}) {
        values->reserve(highest_order + 2 + lane_count);  // callers fill up whole vectors
        values->resize(highest_order + 2);
    }

    const int turn = std::min(highest_order, static_cast<int>(x)) / 2 * 2;  // psi_n oscillates
    const std::vector<double> factors = recurrence_factors(x, highest_order + 1);
    UpwardRecurrence eta_wave{std::sin(x), -std::cos(x)}, psi_wave{std::cos(x), std::sin(x)};
    eta[0] = eta_wave.here;
    psi[0] = psi_wave.here;
    if (inside) {
        const double z = inside_parameter;
        const std::vector<double> inside_factors = recurrence_factors(z, highest_order + 1);
        UpwardRecurrence inside_wave{std::cos(z), std::sin(z)};
        inside[0] = inside_wave.here;
        for (int n = 1; n < turn; n += 2) {
            eta_wave.next_two(&factors[n], &eta[n]);
            psi_wave.next_two(&factors[n], &psi[n]);
            inside_wave.next_two(&inside_factors[n], inside + n);
        }
        for (int n = turn + 1; n <= highest_order; n += 2) {
            eta_wave.next_two(&factors[n], &eta[n]);
            inside_wave.next_two(&inside_factors[n], inside + n);
        }
    } else {
        for (int n = 1; n < turn; n += 2) {
            eta_wave.next_two(&factors[n], &eta[n]);
            psi_wave.next_two(&factors[n], &psi[n]);
        }
        for (int n = turn + 1; n <= highest_order; n += 2) {
            eta_wave.next_two(&factors[n], &eta[n]);
        }
    }
    psi.resize(highest_order + 1);
    eta.resize(highest_order + 1);
    continue_beyond_turn(psi, turn, x);
    return radial;
}

}  // namespace miebrdf::mie
