// Scattering of polarised light by an ensemble of spheres: the whole scattering matrix.
// Symbols, signs and normalisation: docs/conventions.md and
// docs/maths-polarisation.md.
#pragma once

#include <miebrdf/ensemble.h>

#pragma GCC visibility push(default)
namespace miebrdf::mie {

/// The scattering matrix of spheres in generalised spherical functions, entry l = degree l, all of
/// one length:
///     a1 = sum a1_l d^l_00      a2 + a3 = sum (a2_l + a3_l) d^l_22      b1 = sum b1_l d^l_02
///     a4 = sum a4_l d^l_00      a2 - a3 = sum (a2_l - a3_l) d^l_2,-2    b2 = sum b2_l d^l_02
/// with Wigner's functions d^l_mn(Theta). Coefficients contain 2l + 1: a1_l = (2l + 1) chi_l. Of
/// a2, a3, b1 and b2 degrees 0 and 1 are zero.
struct MatrixExpansion {
    std::vector<double> a1, a2, a3, a4, b1, b2;
};

struct MatrixOptics {
    /// Albedo, efficiencies and g as average_over_sizes gives them; chi_l is a1_l / (2l + 1).
    /// Errors, size_nodes and converged are those of both averages together.
    EnsembleOptics optics;
    /// Of spheres a2 = a1 and a4 = a3 as functions of the angle.
    MatrixExpansion expansion;
};

/// The scattering matrix of spheres, averaged by cross-section, as a series.
///
/// Amplitudes S1 and S2 of all sizes at the nodes of a Gauss rule in cos Theta, whose products are
/// polynomials: a1 = (|S1|^2 + |S2|^2) / 2, b1 = (|S2|^2 - |S1|^2) / 2, a3 = Re S2 S1*, b2 =
/// Im S2 S1*. Sizes are refined as for moments, until the estimated error of every coefficient,
/// without its factor 2l + 1, is within the tolerance. Coefficients at the end of the series that
/// are rounding are left out.
///
/// Cost: sizes times partial waves times nodes; milliseconds where size parameters are up to some
/// tens, about a second for hundreds (docs/maths-mie.md).
///
/// @param request  of these: sizes, refractive_index, host_index, wavelength_nm, tolerance and
///                 highest_moment, the degree of the series (-1: all there is)
/// @param run  runs pieces of the work; the result does not depend on it, bit for bit
/// @throws UsageError  as average_over_sizes, and for spheres beyond kLargestMatrixSphere, with
///         the price. Not reaching the tolerance is an outcome: read `converged`.
MatrixOptics average_matrix(const EnsembleRequest& request, const Executor& run = run_in_order);

/// The largest size parameter that average_matrix takes.
inline constexpr double kLargestMatrixSphere = 1800;

/// What average_matrix will take at least, in seconds of one thread (right to a factor of three).
double matrix_seconds(const EnsembleRequest& request);

}  // namespace miebrdf::mie
#pragma GCC visibility pop
