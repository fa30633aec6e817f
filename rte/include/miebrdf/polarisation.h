// What scattering does to polarised light: the scattering matrix of particles without preferred
// direction, and its expansion in generalised spherical functions.
// Symbols and signs: docs/maths-polarisation.md.
#pragma once

#include <functional>
#include <vector>

#pragma GCC visibility push(default)
namespace miebrdf::rte {

/// What one scattering by the angle Theta does to the Stokes vector (I, Q, U, V), Q = parallel
/// minus perpendicular to the plane of scattering:
///     F = [[a1, b1, 0, 0], [b1, a2, 0, 0], [0, 0, a3, b2], [0, 0, -b2, a4]].
/// The mean of a1 over the sphere is 1. Spheres, time factor exp(-i omega t), up to one common
/// factor: a1 = a2 = (|S1|^2 + |S2|^2) / 2, b1 = (|S2|^2 - |S1|^2) / 2, a3 = a4 = Re(S2 S1*),
/// b2 = Im(S2 S1*). Light scattered by small particles is polarised perpendicularly: b1 < 0.
struct ScatteringMatrix {
    double a1 = 0.0, a2 = 0.0, a3 = 0.0, a4 = 0.0, b1 = 0.0, b2 = 0.0;
};

/// How a medium polarises the light that it scatters: what its phase function does not say.
///
/// With Wigner's d^l_mn(Theta) (Legendre's P_l = d^l_00)
///     a1 = sum a1_l d^l_00, a4 = sum a4_l d^l_00, a2 + a3 = sum (a2_l + a3_l) d^l_22,
///     a2 - a3 = sum (a2_l - a3_l) d^l_2,-2, b1 = sum b1_l d^l_02, b2 = sum b2_l d^l_02,
/// so that all coefficients contain 2l + 1; a1_l = (2l + 1) chi_l is Optics::chi, of the same
/// medium. Each list starts at l = 0; a2, a3, b1, b2 are 0 for l < 2. Lists may be of different
/// lengths: beyond their end they are 0.
struct Polarisation {
    std::vector<double> a2, a3, a4, b1, b2;
    /// Optional exact matrix, the mean of a1 over the sphere = 1, for the exact first order of
    /// scattering; a1 is that of Optics::phase. Empty: the coefficients are all of it.
    std::function<ScatteringMatrix(double cos_theta)> matrix;
};

}  // namespace miebrdf::rte
#pragma GCC visibility pop
