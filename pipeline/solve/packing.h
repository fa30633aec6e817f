// Crowded particles: what neighbours change of single scattering.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "pipeline/solve/single_scattering.h"

namespace miebrdf {

/// The structure factor of equal hard spheres (Percus & Yevick 1958), by the factor below.
/// @param volume_fraction  in [0, 0.74]
/// @param qd  momentum transfer times diameter, 2 k d sin(Theta / 2), >= 0
double percus_yevick(double volume_fraction, double qd);

/// Hard spheres of several sizes.
struct HardSpheres {
    std::vector<double> diameter, volume_fraction;
};

/// Q of Baxter's factors S^-1 = Q^H Q of the partial structure factors S_ij of hard spheres in the
/// theory of Percus and Yevick (Baxter 1970; Hiroike 1979; Vrij, J. Chem. Phys. 71, 3267, 1979).
/// @param q  momentum transfer, in the inverse of the unit of the diameters, >= 0
Eigen::MatrixXcd baxter_factor(const HardSpheres& spheres, double q);

/// The factor by which neighbours change the intensity that spheres scatter: sum_ij f_i f_j* S_ij /
/// sum_i |f_i|^2, with f_i the amplitude of a sphere of each kind times the root of their number.
struct Structure {
    HardSpheres spheres;  ///< diameters times the wave number in the host
    std::vector<double> at_angles =
        {};  ///< alike apart from 0 to pi; empty for spheres of one kind

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

/// @throws UsageError  for spheres so large that the moments cannot be integrated
void require_crowd(const ResolvedSpecies& species, std::size_t w);

/// Spheres of one species among all others of their medium, with the scattering cross-section
/// integrated again and the absorption as it was. One size, the effective radius, stands for all of
/// a species (the decoupling approximation).
/// @param alone  with the whole phase function (OpticsDemand::whole_phase_function)
/// @throws UsageError  as require_crowd
MediumOptics crowded(const MediumOptics& alone, const ResolvedSpecies& species, std::size_t w,
                     const std::vector<double>& angles_deg);

/// mu_s' of a medium of spheres, crowded as crowded() does over alone, to about two digits; empty
/// for large spheres, whose forward diffraction alone changes.
std::optional<double> crowding(const ResolvedMedium& medium, std::size_t w);

}  // namespace miebrdf
