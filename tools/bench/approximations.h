// The classical short cuts that a user would otherwise take: closed forms without a solver.
// Each answers for the same scene as the solvers, a base under at most one coat.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace miebrdf::bench {

/// Short cuts know this of a layer: the phase function only through its asymmetry.
struct SimpleLayer {
    double single_scattering_albedo = 0.0;
    double asymmetry = 0.0;
    double optical_depth = 0.0;  ///< of a coat
};

struct SimpleStack {
    SimpleLayer base;
    std::optional<SimpleLayer> coat;
};

/// Kubelka & Munk 1931, Kubelka 1948: two diffuse fluxes; reflectance of a coat on a base, the same
/// for every direction. Coefficients from scattering and absorption as in Star, Marijnissen & van
/// Gemert 1988, eq. 23: K = 2 (1 - a), S = (3 a (1 - g) - (1 - a)) / 4.
/// Meant for diffuse light and weak absorption; nothing (empty) where S <= 0.
std::optional<double> kubelka_munk_reflectance(const SimpleStack& stack);

/// Applies it to a film on a ground of the given diffuse reflectance.
std::optional<double> kubelka_munk_film(const SimpleLayer& film, double ground);

/// Saunderson 1942: a boundary over a body that reflects `body` of diffuse light inside:
/// R = r + (1 - r) (1 - r_int) body / (1 - r_int body). Exact for a Lambertian ground below a clear
/// film.
/// @param outer     Fresnel reflectance r of the incident light
/// @param internal  r_int, of diffuse light from inside
double saunderson(double body, double outer, double internal);

/// Diffusion theory's total diffuse reflectance of a half-space at normal incidence (Farrell,
/// Patterson & Wilson 1992; Jensen et al. 2001, eq. 14, index matched):
/// a'/2 (1 + exp(-4/3 A s)) exp(-s), s = sqrt(3 (1 - a')), a' = a (1 - g) / (1 - a g);
/// A = (1 + r_int) / (1 - r_int) puts the extrapolated boundary higher where a surface reflects.
/// Meant for a' near 1. Knows no coat: empty if there is one.
/// @param internal  r_int, of diffuse light from inside
std::optional<double> diffusion_reflectance(const SimpleStack& stack, double internal = 0);

/// Two fluxes and a beam: the delta-Eddington form of Meador & Weaver 1980 (table 1; eq. 14, 15),
/// scaled by f = g^2 (Joseph, Wiscombe & Weinman 1976). Plane albedo at mu_in; a coat is added to
/// the base with diffuse and direct light apart. Meant for optically thick, weakly absorbing media.
double two_stream_plane_albedo(const SimpleStack& stack, double mu_in);

/// Light scattered once (Blinn 1982; Chandrasekhar 1960, section 27):
/// R = sum over layers of T a P (1 - exp(-tau q)) / (4 (mu_in + mu_out)), q = 1/mu_in + 1/mu_out,
/// T what the layers above let through. Exact as the albedo tends to 0.
/// @param phase  P(Theta) of coat (if any) and base at this geometry
double single_scattering_reflection(const SimpleStack& stack, double mu_in, double mu_out,
                                    double coat_phase, double base_phase);

}  // namespace miebrdf::bench
