// Crowded particles: what neighbours change of single scattering.
#pragma once

#include "pipeline/solve/single_scattering.h"

namespace miebrdf {

/// The structure factor of hard spheres (Percus & Yevick 1958; closed form of Wertheim 1963).
/// @param volume_fraction  in [0, 0.74]
/// @param qd  momentum transfer times diameter, 2 k d sin(Theta / 2), >= 0
double percus_yevick(double volume_fraction, double qd);

/// The factor by which neighbours of the same size change the intensity that spheres scatter: 1 +
/// (S - 1) c, with c = |<F>|^2 / <|F|^2> of their amplitudes F, means over their numbers. Only the
/// mean amplitude interferes, because which sphere has which index is chance; c is 1 where all have
/// one.
struct Structure {
    double volume_fraction = 0.0;
    double kd = 0.0;                    ///< wave number in the host times diameter
    std::vector<double> coherent = {};  ///< c at angles alike apart from 0 to pi; empty: 1

    double operator()(double cos_theta) const;
};

/// P(cos Theta) times the structure / mean, of the function that spheres alone have.
struct CrowdedPhase {
    rte::Optics alone;
    Structure structure;
    double mean = 1.0;  ///< of P times the structure: scattering, crowded over alone

    /// The structure / mean.
    double factor(double cos_theta) const;
    double operator()(double cos_theta) const;
};

/// Names what the structure depends on.
std::string crowd_key(const ResolvedSpecies& species, std::size_t w);

/// Spheres of one species among others of the same sizes, with the scattering cross-section
/// integrated again and the absorption as it was. One size, the effective radius, stands for all
/// (the decoupling approximation); spheres of other sizes do not see each other.
/// @param alone  with the whole phase function (OpticsDemand::whole_phase_function)
/// @throws UsageError  for spheres so large that the moments cannot be integrated
MediumOptics crowded(const MediumOptics& alone, const ResolvedSpecies& species, std::size_t w,
                     const std::vector<double>& angles_deg);

/// mu_s' of spheres of the effective radius, crowded over alone; empty for large spheres, whose
/// forward diffraction alone changes.
std::optional<double> crowding(const ResolvedSpecies& species, std::size_t w);

}  // namespace miebrdf
