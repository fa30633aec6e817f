// What to compute of an ensemble of spheres.
#pragma once

#include <complex>
#include <vector>

#include <miebrdf/sizes.h>

namespace miebrdf::mie {

/// What to compute; what is not asked for is not computed.
struct EnsembleRequest {
    SizeDistribution sizes = {};
    std::complex<double> refractive_index = {};  ///< of the particles, n + ik, k >= 0
    double host_index = 1.0;                     ///< real index of the medium between them
    double wavelength_nm = 550.0;                ///< in vacuum
    int highest_moment = -1;                     ///< chi_0 ... chi_L; -1: no moments
    std::vector<double> angles_deg = {};  ///< scattering angles for the phase function, 0 to 180
    double tolerance = 1e-4;              ///< relative, of albedo, q_ext and moments
    double phase_tolerance = 1e-2;        ///< relative, of P at each angle listed, and rms over
                                          ///< each panel of a phase table; points of P need many
                                          ///< more sizes than moments do
    double phase_floor = 0;               ///< a phase table's P below this is resolved relative to
                                          ///< this: dim angles do not matter to radiative transfer
    bool with_phase_table = false;        ///< P at every angle, as a PhaseTable
    double table_tolerance = 1e-3;        ///< of its interpolation, relative within each panel
};

/// @throws std::invalid_argument  with the value and what is allowed
void validate(const EnsembleRequest& request);

/// refractive_index / host_index, n + ik.
std::complex<double> relative_index_of(const EnsembleRequest& request);

/// 2 pi n_host / lambda: times a radius in um, the size parameter.
double wave_number_per_um(const EnsembleRequest& request);

/// Degree of the last Legendre moment that is not zero within rounding: twice the number of partial
/// waves of the largest sphere.
int highest_moment_of(const EnsembleRequest& request);

}  // namespace miebrdf::mie
