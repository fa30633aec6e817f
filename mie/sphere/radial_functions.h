// Riccati-Bessel functions of one sphere: psi_n(x) and eta_n(x) outside, the logarithmic derivative
// of psi_n(mx) inside, and how many orders n are needed.
#pragma once

#include <complex>
#include <optional>
#include <vector>

#include "mie/sphere/kept_memory.h"

namespace miebrdf::mie {

/// Number of terms after which a_n and b_n of a sphere of this size are below rounding:
/// x + 8 x^(1/3) + 12. (Wiscombe 1980, Appl. Opt. 19, 1505, stops at x + 4.05 x^(1/3) + 2, where
/// amplitudes away from the forward peak keep only 7 to 10 digits.)
int number_of_terms(double size_parameter);

/// psi_n = x j_n(x) and eta_n = x y_n(x), n = 0 ... highest_order; the outgoing wave is
/// xi_n = psi_n + i eta_n (time factor exp(-i omega t)).
struct RadialFunctions {
    KeptVector<double> psi;
    KeptVector<double> eta;
};

/// eta_n upward; psi_n upward while it oscillates (n <= x), above that from the ratio
/// psi_n / psi_{n-1} = x / (2n + 1 + E_n(x)): upward it would drown in eta_n.
///
/// @param inside  when not null, filled with psi_n(inside_parameter), n = 0 ... highest_order + 1,
///                upward: a third recurrence costs little beside the two, whose latency it shares
RadialFunctions radial_functions(double size_parameter, int highest_order, double* inside = nullptr,
                                 double inside_parameter = 1);

/// D_n(z) = psi_n'(z) / psi_n(z), psi_n(z) = z j_n(z), for n = 0 ... highest_order.
///
/// Downward recurrence D_{n-1} = n/z - 1/(D_n + n/z), started well above max(order, |z|), where any
/// start is forgotten. When |z| is far above the order that is wasted work, and two other ways in
/// are used: upward from cot z when z is (nearly) real, or the WKB expansion at the highest order
/// when the wave from the far side is damped below rounding.
///
/// @param z  size parameter inside the sphere, m x; |z| > 0, Im z >= 0
std::vector<std::complex<double>> logarithmic_derivatives(std::complex<double> z,
                                                          int highest_order);

/// Logarithmic derivatives for real z, in real arithmetic.
std::vector<double> logarithmic_derivatives(double z, int highest_order);

/// D_n(z) at one order by the WKB expansion of its Riccati equation, to rounding; empty where the
/// expansion is not that good (the order within 30 % of |z| or above it) or the wave from the far
/// side counts (damped by less than exp(-36) on its way there and back).
std::optional<std::complex<double>> damped_logarithmic_derivative(std::complex<double> z,
                                                                  int order);

/// The order from which a downward recurrence forgets any start before it comes to highest_order.
/// @param modulus  |z|
int safe_start(double modulus, int highest_order);

/// True where psi_n can be taken upward to this order with the loss of a digit of sixteen at most.
/// Its errors have the part of the wave exp(iz), which grows against psi_n ~ exp(-i phi) by
/// exp(2 (Im z - Im phi)), phi = integral of sqrt(1 - n^2/z^2) dz: little while n is well below
/// |z|, however damped the wave is.
bool upward_is_stable(std::complex<double> z, int highest_order);

/// E_n(z) = z D_n(z) - (n + 1) = -z^2 / (2n + 3 + E_{n+1}), n = 0 ... highest_order: what is left
/// of D_n once its pole at z = 0 is taken out. It keeps all digits as z -> 0, where D_n hides it.
/// Valid for |z| <= 4, below the first zero of psi_1; for real z up to n + 1 at each order n.
template <typename Number>
std::vector<Number> regular_logarithmic_derivatives(Number z, int highest_order);

}  // namespace miebrdf::mie
