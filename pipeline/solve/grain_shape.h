// Grains that are no spheres, and smooth phase functions: what becomes of the averages of Mie
// theory.
#pragma once

#include "pipeline/solve/single_scattering.h"

namespace miebrdf {

/// The aspect of spheroids that state none.
inline constexpr double kSpheroidAspect = 0.5;

/// Whether the phase function is a smooth one and not that of Mie theory.
bool has_smooth_phase(const Species& species);

/// Asymmetry of ice grains at a vacuum wavelength of 0.2 to 5 um.
///
/// g = g_hex C: g_hex = g' + (1 - g') / (2 albedo), with the geometric part g' by Fu (2007, J.
/// Atmos. Sci. 64, 4140, eq. 3.1 and 3.3) for spheroids and hexagonal plates of an aspect ratio,
/// C by He et al. (2017, J. Climate 30, 10025, eq. 6 and 7) for the shape factor and the size;
/// coefficients of bands are interpolated monotonically between the middles of the bands and held
/// beyond them, g is 0.99 at most, as in SNICAR-ADv3 (Flanner et al. 2021, Geosci. Model Dev. 14,
/// 7673).
/// @pre shape.kind is not a sphere
double grain_asymmetry(const GrainShape& shape, double wavelength_nm, double effective_radius_um,
                       double single_scattering_albedo);

/// 1 - albedo of grains whose absorption is enhanced by B, where spheres of the same effective
/// radius have `of_spheres`. Libois et al. (2013, The Cryosphere 7, 1803): in weak absorption
/// 1 - albedo goes with B, 1.25 for spheres; it saturates as (1 - W)/2 (1 - exp(-B c)), W = 0.0611
/// what grains of ice reflect (Kokhanovsky & Zege 2004, Appl. Opt. 43, 1589).
double enhanced_absorption(double absorption, double of_spheres);

/// Two lobes of Henyey and Greenstein that share the moments chi_0 ... chi_3 with a phase function
/// (Kattawar 1975, J. Quant. Spectrosc. Radiat. Transfer 15, 839).
struct DoubleLobe {
    double forward = 0.0, backward = 0.0;  ///< asymmetries of the lobes
    double share = 1.0;                    ///< of the forward one
};

/// @throws UsageError  where no two lobes have these moments
DoubleLobe double_lobe(double chi1, double chi2, double chi3);

/// The same particles with the phase function of Mie theory: their averages over sizes are what a
/// smooth phase function is made from. Others, which keep their own, are returned as they are.
Species averaged_words(Species species);

/// averaged_words at one wavelength, which becomes the first.
/// @pre species.needs_mie()
ResolvedSpecies averaged_particles(const ResolvedSpecies& species, std::size_t w);

/// What is demanded of averaged_particles: for a smooth phase function extinction, albedo, and
/// chi_1 or chi_1 ... chi_3; else the same.
OpticsDemand demand_of_average(const Species& species, const OpticsDemand& demand);

/// Whether a demand is of averages for a smooth phase function.
bool is_of_average(const OpticsDemand& demand);

/// One species with a smooth phase function at one wavelength.
/// @param spheres  averaged_particles, as much as demand_of_average asks for
/// @throws UsageError  where no two lobes have the moments of the spheres
MediumOptics smooth_optics(const ResolvedSpecies& species, std::size_t w,
                           const OpticsDemand& demand, const MediumOptics& spheres);

/// Refuses grains of what their coefficients do not describe. @throws UsageError
void require_grains(const ResolvedSpecies& species);

}  // namespace miebrdf
