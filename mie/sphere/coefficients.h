// Mie coefficients a_n, b_n of one homogeneous sphere.
#pragma once

#include <complex>
#include <vector>

namespace miebrdf::mie {

/// Partial waves n = 1 ... terms; entry n - 1 holds order n. Time factor exp(-i omega t).
struct Coefficients {
    std::vector<std::complex<double>> a;  ///< electric
    std::vector<std::complex<double>> b;  ///< magnetic
    /// (Re a_n - |a_n|^2) + (Re b_n - |b_n|^2), the part that is absorbed: from the Wronskian, not
    /// from that difference. Exactly 0 for a real index.
    std::vector<double> absorbed;
};

/// Bohren & Huffman 1983, eq. (4.88), with
///     a_n = p / (p + i q),  p = A psi_n - psi_{n-1},  q = A eta_n - eta_{n-1},
/// A = D_n(mx)/m + n/x for a_n and m D_n(mx) + n/x for b_n. The Wronskian
/// psi_n eta_{n-1} - psi_{n-1} eta_n = 1 gives Re a_n - |a_n|^2 = -Im A / |p + i q|^2: every term
/// of the absorption is positive. Small spheres, where p cancels, take differences of logarithmic
/// derivatives in closed form instead (docs/maths-mie.md).
///
/// Cost: x + 8 x^(1/3) + 12 terms, plus |m| x steps of the logarithmic derivative at most.
///
/// @param relative_index  m = n + ik of the sphere over its host; n in [0.01, 100], k in [0, 10000]
/// @param size_parameter  x = 2 pi r n_host / lambda, in [1e-30, 1e7]
/// @throws std::invalid_argument  out of range
Coefficients mie_coefficients(std::complex<double> relative_index, double size_parameter);

}  // namespace miebrdf::mie
