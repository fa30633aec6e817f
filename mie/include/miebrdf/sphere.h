// Optics of one sphere, homogeneous or of layers: efficiencies, scattering amplitudes, Mie
// coefficients. Symbols, signs and normalisation: docs/conventions.md.
#pragma once

#include <complex>
#include <span>
#include <string>
#include <vector>

#include <miebrdf/language.h>

#pragma GCC visibility push(default)
namespace miebrdf::mie {

/// Efficiencies are cross-sections over pi r^2.
struct SphereOptics {
    double q_ext = 0.0;      ///< q_sca + q_abs
    double q_sca = 0.0;      ///< scattering / pi r^2
    double q_abs = 0.0;      ///< summed, never extinction minus scattering; exactly 0 for k = 0
    double q_back = 0.0;     ///< radar backscattering, 4 |S(180)|^2 / x^2
    double asymmetry = 0.0;  ///< g, mean cosine of the scattering angle
    int terms = 0;           ///< partial waves summed
    double accuracy = 0.0;   ///< estimated relative error of the efficiencies from rounding
    bool reached = false;    ///< accuracy <= 1e-12
    std::string status;      ///< empty, or what was not reached and why
};

/// Lorenz-Mie theory of one sphere; the arguments of mie_coefficients.
///
/// Measured against 60-digit tables: efficiencies to 1e-12 from x = 1e-8 to 1e6; an index within
/// 1e-3 of the host's (m near 1) keeps as many digits as |m - 1| has above rounding.
///
/// @throws UsageError  index or size parameter out of range
SphereOptics scatter_by_sphere(std::complex<double> relative_index, double size_parameter);

/// A layer of a sphere, from its core outwards.
struct SphereLayer {
    std::complex<double> relative_index;  ///< n + ik over the host's
    double size_parameter;                ///< at its outer surface, >= that of the layer below
};

/// A sphere of layers; efficiencies are over the cross-section of the whole (mie_coefficients).
///
/// Measured against a 60-digit table: 1e-10 for size parameters of 0.03 to 200.
/// @throws UsageError  index or size parameter out of range, or layers out of order
SphereOptics scatter_by_sphere(std::span<const SphereLayer> layers);

/// S1 (electric field perpendicular to the scattering plane) and S2 (parallel), one entry per
/// angle. Time factor exp(-i omega t): tables for exp(+i omega t) hold the complex conjugates.
struct Amplitudes {
    std::vector<std::complex<double>> s1, s2;  ///< dimensionless
};

/// S1 = sum (2n+1)/(n(n+1)) (a_n pi_n + b_n tau_n), S2 with pi_n and tau_n exchanged
/// (Bohren & Huffman 1983, eq. 4.74).
///
/// @param angles_deg  scattering angles, 0 (forward) to 180
/// @throws UsageError  arguments as for mie_coefficients; an angle out of range
Amplitudes scattering_amplitudes(std::complex<double> relative_index, double size_parameter,
                                 std::span<const double> angles_deg);

Amplitudes scattering_amplitudes(std::span<const SphereLayer> layers,
                                 std::span<const double> angles_deg);  ///< likewise

/// cos of an angle in degrees, exact at 0, 60, 90, 120 and 180.
/// @throws UsageError  outside 0 to 180
double cosine_of_scattering_angle(double angle_deg);

/// Partial waves n = 1 ... terms; entry n - 1 holds order n. Time factor exp(-i omega t).
struct Coefficients {
    std::vector<std::complex<double>> a;  ///< electric, dimensionless
    std::vector<std::complex<double>> b;  ///< magnetic, dimensionless
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
/// @throws UsageError  out of range
Coefficients mie_coefficients(std::complex<double> relative_index, double size_parameter);

/// Partial waves of a sphere of layers (Aden & Kerker 1951): logarithmic derivatives of the waves
/// inside are taken from one surface to the next by ratios of Riccati-Bessel functions (Yang 2003,
/// Appl. Opt. 42, 1710), which neither overflow in thick absorbing layers nor lose thin ones.
///
/// Cost: as many logarithmic derivatives as there are surfaces, twice for those between layers.
/// Layers that absorb hardly at all keep as many digits of the absorption as k has above rounding.
Coefficients mie_coefficients(std::span<const SphereLayer> layers);

/// Amplitudes from coefficients that are known already.
Amplitudes scattering_amplitudes(const Coefficients& coefficients,
                                 std::span<const double> angles_deg);

}  // namespace miebrdf::mie
#pragma GCC visibility pop
