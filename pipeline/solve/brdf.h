// The spectral BRDF of a scene: every wavelength through Mie theory, radiative transfer and the
// surface lobe.
#pragma once

#include <string>
#include <vector>

#include "pipeline/scene/request.h"
#include "pipeline/solve/phase_noise.h"
#include "pipeline/solve/physics_report.h"
#include "pipeline/solve/run_control.h"
#include "rte/stack/layered_reflection.h"

namespace miebrdf {

/// Values at one wavelength, laid out as in rte::ReflectionTable:
/// [(i * mu_out.size() + o) * azimuth_deg.size() + a]. All are BRDFs in 1/sr without the cosine.
/// Parts that Request::parts does not ask for may be empty.
struct SpectralSlice {
    double wavelength_nm = 0.0;
    std::vector<double> subsurface;   ///< R / pi of the layers alone
    std::vector<double> surface;      ///< the lobe R_s; empty without a surface
    std::vector<double> total;        ///< surface + transmitted subsurface (Chen et al., eq. 5)
    PhysicsReport layers_physics;     ///< of subsurface
    PhysicsReport physics;            ///< of total, or of the one part that was asked for
    double mie_error_estimate = 0.0;  ///< largest of the media
    PhaseNoise phase_noise;           ///< of single directions; not in error_estimate
    rte::SolverReport report;
    double error_estimate = 0.0;  ///< of both steps together
    bool converged = false;       ///< every step reached its tolerance
};

struct BrdfResult {
    std::vector<SpectralSlice> slices;  ///< in the order of Request::wavelength_nm
    std::vector<std::string> sources;   ///< where the figures come from, one line for each medium
    bool converged = false;
    double error_estimate = 0.0;  ///< largest over the wavelengths
    PhaseNoise phase_noise;       ///< the same
    double phase_noise_wavelength_nm = 0.0;
};

/// Computes a request; wavelengths run in parallel, with the same result for any number of threads.
/// @throws UsageError, InputError, Cancelled
BrdfResult compute_brdf(const Request& request, const RunControl& control = {});

/// Plane albedo at Request::directions.mu_in and spherical albedo. With a surface both are those of
/// the whole: rho + (1 - rho) A.
struct AlbedoSlice {
    double wavelength_nm = 0.0;
    std::vector<double> plane_albedo;  ///< one for each mu_in
    double spherical_albedo = 0.0;
    double mie_error_estimate = 0.0;
    PhaseNoise phase_noise;  ///< none: an albedo averages it out
    rte::SolverReport report;
    double error_estimate = 0.0;
    bool converged = false;
};

struct AlbedoResult {
    std::vector<AlbedoSlice> slices;
    std::vector<std::string> sources;
    bool converged = false;
    double error_estimate = 0.0;
    PhaseNoise phase_noise;
    double phase_noise_wavelength_nm = 0.0;
};

/// Azimuthal order 0 alone; Request::directions.mu_out and azimuth_deg and Request::parts are not
/// read.
/// @throws UsageError, InputError, Cancelled
AlbedoResult compute_albedo(const Request& request, const RunControl& control = {});

}  // namespace miebrdf
