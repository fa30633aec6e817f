// Riccati-Bessel functions of the size parameter, outside the sphere.
#pragma once

#include <vector>

namespace miebrdf::mie {

/// psi_n = x j_n(x) and eta_n = x y_n(x), n = 0 ... highest_order; the outgoing wave is
/// xi_n = psi_n + i eta_n (time factor exp(-i omega t)).
struct RadialFunctions {
    std::vector<double> psi;
    std::vector<double> eta;
};

/// eta_n upward; psi_n upward while it oscillates (n <= x), above that from the ratio
/// psi_n / psi_{n-1} = x / (2n + 1 + E_n(x)): upward it would drown in eta_n.
///
/// @param inside  when not null, filled with psi_n(inside_parameter), n = 0 ... highest_order + 1,
///                upward: a third recurrence costs little beside the two, whose latency it shares
RadialFunctions radial_functions(double size_parameter, int highest_order, double* inside = nullptr,
                                 double inside_parameter = 1);

}  // namespace miebrdf::mie
