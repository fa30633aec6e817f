// Scattering amplitudes S1, S2 of one sphere in given directions.
#pragma once

#include <complex>
#include <span>
#include <vector>

#include "mie/sphere/coefficients.h"

namespace miebrdf::mie {

/// S1 (electric field perpendicular to the scattering plane) and S2 (parallel), one entry per
/// angle. Time factor exp(-i omega t): tables for exp(+i omega t) hold the complex conjugates.
struct Amplitudes {
    std::vector<std::complex<double>> s1, s2;
};

/// S1 = sum (2n+1)/(n(n+1)) (a_n pi_n + b_n tau_n), S2 with pi_n and tau_n exchanged
/// (Bohren & Huffman 1983, eq. 4.74).
///
/// @param angles_deg  scattering angles, 0 (forward) to 180
/// @throws std::invalid_argument  arguments as for mie_coefficients; an angle out of range
Amplitudes scattering_amplitudes(std::complex<double> relative_index, double size_parameter,
                                 std::span<const double> angles_deg);

Amplitudes scattering_amplitudes(const Coefficients& coefficients,
                                 std::span<const double> angles_deg);

/// cos of an angle in degrees, exact at 0, 60, 90, 120 and 180.
/// @throws std::invalid_argument  outside 0 to 180
double cosine_of_scattering_angle(double angle_deg);

}  // namespace miebrdf::mie
