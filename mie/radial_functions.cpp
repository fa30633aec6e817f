#include "mie/radial_functions.h"

#include <algorithm>
#include <cmath>

#include "mie/terms.h"

namespace miebrdf::mie {
namespace {

// f_n = (2n - 1)/z f_{n-1} - f_{n-2}. Divided, not times 1/z: that would be another z, by a
// rounding, for all orders.
struct UpwardRecurrence {
    UpwardRecurrence(double argument, double minus_first, double zeroth)
        : z(argument), before(minus_first), here(zeroth) {}
    double next(int n) {
        const double value = (2 * n - 1) / z * here - before;
        before = here;
        return here = value;
    }
    double z, before, here;
};

}  // namespace

int number_of_terms(double size_parameter) {
    // Below x = 0.001 each term is 10^-6 of the one before; fewer keep eta_n ~ x^-n from overflow.
    if (size_parameter < 1e-3) return 6;
    return static_cast<int>(size_parameter + 8 * std::cbrt(size_parameter) + 12);
}

RadialFunctions radial_functions(double size_parameter, int highest_order, double* inside,
                                 double inside_parameter) {
    const double x = size_parameter;
    RadialFunctions radial{std::vector<double>(highest_order + 1),
                           std::vector<double>(highest_order + 1)};
    std::vector<double>& psi = radial.psi;
    std::vector<double>& eta = radial.eta;

    const int turn = std::min(highest_order, static_cast<int>(x));  // psi_n still oscillates
    UpwardRecurrence eta_wave(x, std::sin(x), -std::cos(x));
    UpwardRecurrence psi_wave(x, std::cos(x), std::sin(x));
    UpwardRecurrence inside_wave(inside_parameter, std::cos(inside_parameter),
                                 std::sin(inside_parameter));
    eta[0] = eta_wave.here;
    psi[0] = psi_wave.here;
    if (inside) {
        inside[0] = inside_wave.here;
        for (int n = 1; n <= turn; ++n) {
            eta[n] = eta_wave.next(n);
            psi[n] = psi_wave.next(n);
            inside[n] = inside_wave.next(n);
        }
        for (int n = turn + 1; n <= highest_order; ++n) {
            eta[n] = eta_wave.next(n);
            inside[n] = inside_wave.next(n);
        }
    } else {
        for (int n = 1; n <= turn; ++n) {
            eta[n] = eta_wave.next(n);
            psi[n] = psi_wave.next(n);
        }
        for (int n = turn + 1; n <= highest_order; ++n) eta[n] = eta_wave.next(n);
    }
    double E = 0;  // E_n(x) of logarithmic_derivative.h, downward
    for (int n = highest_order + static_cast<int>(2 * std::cbrt(x)) + 15; n > turn; --n) {
        E = -x * x / (2 * n + 3 + E);
        if (n <= highest_order) psi[n] = x / (2 * n + 1 + E);
    }
    for (int n = turn + 1; n <= highest_order; ++n) psi[n] *= psi[n - 1];
    return radial;
}

}  // namespace miebrdf::mie
