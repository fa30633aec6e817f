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

    double before = std::sin(x);  // eta_{-1}
    eta[0] = -std::cos(x);
    for (int n = 1; n <= highest_order; ++n) {
        eta[n] = (2 * n - 1) / x * eta[n - 1] - before;
        before = eta[n - 1];
    }

    const int turn = std::min(highest_order, static_cast<int>(x));  // psi_n still oscillates
    before = std::cos(x);                                           // psi_{-1}
    psi[0] = std::sin(x);
    for (int n = 1; n <= turn; ++n) {
        psi[n] = (2 * n - 1) / x * psi[n - 1] - before;
        before = psi[n - 1];
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
