#include "mie/radial_functions.h"

#include <algorithm>
#include <cmath>

#include "mie/terms.h"

namespace miebrdf::mie {

int number_of_terms(double size_parameter) {
    // Below x = 0.001 each term is 10^-6 of the one before; fewer keep eta_n ~ x^-n from overflow.
    if (size_parameter < 1e-3) return 6;
    return static_cast<int>(size_parameter + 8 * std::cbrt(size_parameter) + 12);
}

RadialFunctions radial_functions(double size_parameter, int highest_order) {
    const double x = size_parameter;
    RadialFunctions radial{std::vector<double>(highest_order + 1),
                           std::vector<double>(highest_order + 1)};
    std::vector<double>& psi = radial.psi;
    std::vector<double>& eta = radial.eta;

    const int turn = std::min(highest_order, static_cast<int>(x));  // psi_n still oscillates
    double eta_before = std::sin(x), eta_here = -std::cos(x);       // eta_{-1}, eta_0
    double psi_before = std::cos(x), psi_here = std::sin(x);        // psi_{-1}, psi_0
    eta[0] = eta_here;
    psi[0] = psi_here;
    // Two recurrences in one loop hide each other's latency.
    for (int n = 1; n <= turn; ++n) {
        const double factor = (2 * n - 1) / x;
        const double next_eta = factor * eta_here - eta_before;
        const double next_psi = factor * psi_here - psi_before;
        eta_before = eta_here;
        psi_before = psi_here;
        eta[n] = eta_here = next_eta;
        psi[n] = psi_here = next_psi;
    }
    for (int n = turn + 1; n <= highest_order; ++n) {
        const double next_eta = (2 * n - 1) / x * eta_here - eta_before;
        eta_before = eta_here;
        eta[n] = eta_here = next_eta;
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
