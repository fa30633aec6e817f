// Whether the polarisation of light matters to a request: what the solver asks, and `plan`.
#pragma once

#include <miebrdf/brdf.h>
#include <miebrdf/optics.h>
#include <miebrdf/solver.h>

#include <string>
#include <vector>

#include "pipeline/solve/layers.h"
#include "pipeline/solve/resolved_scene.h"

namespace miebrdf {

/// The promise of `auto` where spheres are coarse: their polarisation changes no value by more,
/// relative to the largest at that incidence. Finer ones are held to the tolerance. What is found
/// to be beyond that says so (ResultReport::polarisation) and is not converged.
inline constexpr double kPromisedWithoutPolarisation = 6e-3;

/// LightChoice::left_out where the change is not known: all of a value may change.
inline constexpr double kNotCompared = 1.0;

/// How light is computed at one wavelength.
struct LightChoice {
    int components = 1;       ///< 1, 3 or 4
    double left_out = 0.0;    ///< WavelengthReport::polarisation_left_out
    std::string reason = {};  ///< "no layer polarises ...", ...
    /// Scattering matrices tell (light_of); `components` are what is expected.
    bool needs_comparison = false;
    /// A comparison tells that what is left out is more than is promised: values are not converged.
    bool is_beyond_promise = false;
};

/// Empty, or why light of several components cannot be computed: "a boundary ...".
std::string why_no_polarisation(const ResolvedScene& scene, const SolverOptions& solver);
/// @throws UsageError  where several components are asked for and cannot be computed
void require_light(const ResolvedScene& scene, const SolverOptions& solver);

/// The choice that can be made before single scattering: by what was asked for, and by media that
/// do not polarise. `components` are those expected where needs_comparison.
/// @throws UsageError  as require_light
LightChoice choose_light(const LayerRequest& request, std::size_t w);

/// The choices for some of the scene's wavelengths, by comparisons where these are needed.
std::vector<LightChoice> light_of(const LayerRequest& request,
                                  const std::vector<std::size_t>& wavelengths,
                                  const Control& control);

/// Writes what was chosen into a report that has been judged.
void state_light(const LightChoice& light, WavelengthReport& report);

}  // namespace miebrdf
