// Input of radiative transfer: single scattering by each medium (from Mie theory, a
// formula or a file), and what lies on what.
// Symbols, signs and normalisation: docs/conventions.md.
#pragma once

#include <complex>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include <miebrdf/matrix_expansion.h>
#include <miebrdf/surface.h>

#pragma GCC visibility push(default)
namespace miebrdf::rte {

/// The scattering matrix of particles without preferred direction (docs/maths-polarisation.md):
/// what one scattering by the angle Theta does to the Stokes vector (I, Q, U, V), Q = parallel
/// minus perpendicular to the plane of scattering:
///     F = [[a1, b1, 0, 0], [b1, a2, 0, 0], [0, 0, a3, b2], [0, 0, -b2, a4]].
/// The mean of a1 over the sphere is 1. Spheres, time factor exp(-i omega t), up to one common
/// factor: a1 = a2 = (|S1|^2 + |S2|^2) / 2, b1 = (|S2|^2 - |S1|^2) / 2, a3 = a4 = Re(S2 S1*),
/// b2 = Im(S2 S1*). Light scattered by small particles is polarised perpendicularly: b1 < 0.
struct ScatteringMatrix {
    double a1 = 0.0, a2 = 0.0, a3 = 0.0, a4 = 0.0, b1 = 0.0, b2 = 0.0;
};

/// How a medium polarises the light that it scatters: what its phase function does not say. All
/// coefficients contain 2l + 1, as a1_l = (2l + 1) chi_l of Optics::chi of the same medium.
struct Polarisation : MatrixExpansion {
    /// Optional exact matrix, the mean of a1 over the sphere = 1, for the exact first order of
    /// scattering; a1 is that of Optics::phase. Empty: the coefficients are all of it.
    std::function<ScatteringMatrix(double cos_theta)> matrix;
};

/// Single scattering by a homogeneous medium.
struct Optics {
    double single_scattering_albedo = 0.0;  ///< scattering / extinction, in [0, 1]
    /// Absorption / extinction: carried separately, so that it keeps its digits when the albedo is
    /// close to 1.
    double one_minus_albedo = 1.0;
    std::vector<double> chi = {1.0};  ///< Legendre moments chi_0 = 1, chi_1 = g, ...; zero beyond
    /// True: chi was cut short, the phase function has more moments than it lists. Then at most
    /// chi.size() - 1 of them are kept, so that delta-M knows the first one it leaves out.
    bool has_more_moments = false;
    /// Optional exact phase function P(cos Theta), mean over the sphere = 1, for the exact first
    /// order of scattering. Empty: the moments are the whole phase function.
    /// Functions with narrow features (glory, rainbows) need all their moments in chi as well: what
    /// is beyond delta-M is corrected from them.
    std::function<double(double cos_theta)> phase;
    /// Its scattering of polarised light, for the Stokes solver alone. Null: whatever it scatters
    /// is unpolarised, as if a1 were all of its scattering matrix.
    std::shared_ptr<const Polarisation> polarisation = {};
};

/// Checks albedo, one_minus_albedo, chi_0, |chi_l| <= 1 and, where there is one, the polarisation:
/// all coefficients finite, those of degrees that do not exist 0, and no degree sends out more
/// polarised light than it receives (|x_l| <= 2l + 1).
/// @throws UsageError  naming what is out of range
void validate(const Optics& optics);

/// P = 1 in all directions: chi_0 alone, and no function beside it.
/// @param single_scattering_albedo  in [0, 1]; one_minus_albedo is what subtraction gives
/// @throws UsageError  for an albedo out of range
Optics isotropic_optics(double single_scattering_albedo);
/// P = 3/4 (1 + cos^2 Theta) = 1 + P_2(cos Theta) / 2: Rayleigh scattering by spheres much smaller
/// than the wavelength (Chandrasekhar 1960, ch. I, section 3). Three moments, chi = (1, 0, 1/10),
/// are all of it. Its polarisation comes with it.
/// @param single_scattering_albedo  in [0, 1]
/// @param depolarisation_factor  of molecules that are no spheres, rho = I_parallel /
///        I_perpendicular of unpolarised light scattered by 90 degrees, in [0, 6/7]; air .0279.
///        chi_2 = (1 - rho) / (10 + 5 rho)
/// @throws UsageError  for an albedo or a factor out of range
Optics rayleigh_optics(double single_scattering_albedo, double depolarisation_factor = 0.0);
/// P = (1 - g^2) / (1 + g^2 - 2 g cos Theta)^(3/2) (Henyey and Greenstein 1941): chi_l = g^l up to
/// where (2l + 1) g^l is below rounding, at most 2^20 of them, and the exact P.
/// @param single_scattering_albedo  in [0, 1]
/// @param asymmetry  g in (-1, 1)
/// @throws UsageError  for an albedo or asymmetry out of range
Optics henyey_greenstein_optics(double single_scattering_albedo, double asymmetry);

/// One scatterer of a mixture.
struct MixtureComponent {
    Optics optics;
    double extinction = 0.0;  ///< its part of the mixture's extinction, any unit, >= 0
};

/// The phase function of a mixture: those of its components by their shares of the scattering.
struct MixedPhase {
    std::vector<Optics> components;
    std::vector<double> share;  ///< adds up to 1

    double operator()(double cos_theta) const;  ///< P at a scattering angle's cosine
};

/// Several scatterers in one layer: albedos average by extinction, moments, phase functions and
/// polarisation by scattering. The exact phase function (MixedPhase) and the exact scattering
/// matrix are kept if any component has one.
/// @throws UsageError  for no component, an extinction that is negative or not finite, or a sum of
///         zero
Optics mix(const std::vector<MixtureComponent>& components);

/// A homogeneous layer.
struct Coat {
    Optics optics;
    double optical_depth = 0.0;  ///< of extinction, vertical, >= 0; may be infinite
    /// Refractive index of what lies between the particles, in [1, 3]. It matters where there is a
    /// Boundary, or a mirror below.
    double index = 1.0;
};

enum class BaseKind {
    half_space,  ///< a medium without end
    lambertian,  ///< a ground that reflects `ground_albedo` of the flux alike in all directions
    none,        ///< nothing: black
    mirror,      ///< a smooth surface of `mirror_index`; what passes it is gone
    brdf,        ///< a ground that reflects by `ground`, in air
};

/// A base and its coats in painting order: the last one is on top.
struct Stack {
    Optics base = {};  ///< of the half-space; ignored for the other kinds
    std::vector<Coat> coats = {};
    BaseKind base_kind = BaseKind::half_space;
    double ground_albedo = 0.0;  ///< in [0, 1], of the Lambertian ground
    GroundBrdf ground = {};      ///< of BaseKind::brdf; unpolarised light leaves it
    /// n + ik of the mirror: of a metal, or 1 for the lower side of a free film.
    std::complex<double> mirror_index = 1.0;
    /// Index as Coat::index: of the half-space, or of what lies on the ground where there is no
    /// coat.
    double base_index = 1.0;
    /// Between air and the topmost medium. Media of different indices below it are separated by
    /// smooth boundaries. Empty: indices are not looked at, light enters as if there were none.
    std::optional<Boundary> boundary = {};
};

/// The index of what lies directly under the air.
double top_index(const Stack& stack);

/// Checks every medium, optical depth and the ground's albedo.
/// @throws UsageError  naming what is out of range
void validate(const Stack& stack);

}  // namespace miebrdf::rte
#pragma GCC visibility pop
