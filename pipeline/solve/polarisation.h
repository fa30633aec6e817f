// Whether the polarisation of light matters to a request: what the solver asks, and `plan`.
#pragma once

#include <miebrdf/brdf.h>
#include <miebrdf/optics.h>
#include <miebrdf/solver.h>

#include <string>
#include <vector>

#include "pipeline/solve/layers.h"
#include "pipeline/solve/resolved_scene.h"
#include "pipeline/solve/scene_optics.h"

namespace miebrdf {

/// The promise of `auto` where spheres are coarse: their polarisation changes no value by more,
/// relative. Finer ones are held to the tolerance. What is beyond both says so
/// (ResultReport::polarisation) and is not converged.
inline constexpr double kPromisedWithoutPolarisation = 6e-3;

/// How light is computed at one wavelength.
struct LightChoice {
    int components = 1;       ///< 1, 3 or 4
    double allowed = 0.0;     ///< change of the values by what is left out; see needs_matrices
    double left_out = 0.0;    ///< WavelengthReport::polarisation_left_out
    std::string reason = {};  ///< "no layer polarises what it scatters", ...
    /// With 1 component: nothing is known yet of how strongly the layers polarise; their scattering
    /// matrices tell (light_and_optics).
    bool needs_matrices = false;
    /// Those of few sizes come first, which mostly tell that polarisation does not show.
    bool begins_coarsely = false;
    /// Likewise, but by matrices of smaller spheres and below a smooth boundary: what their own
    /// matrices would cost, or nothing else can compute.
    bool needs_stand_ins = false;
    /// A comparison tells that what is left out is more than is promised: values are not converged.
    bool is_beyond_promise = false;
};

/// Empty, or why light of several components cannot be computed: "a boundary ...".
std::string why_no_polarisation(const ResolvedScene& scene, const SolverOptions& solver);
/// @throws UsageError  where several components are asked for and cannot be computed
void require_light(const ResolvedScene& scene, const SolverOptions& solver);

/// The choice that can be made before single scattering: by what was asked for, media that do not
/// polarise, and which matrices may tell.
/// @throws UsageError  as require_light
LightChoice choose_light(const LayerRequest& request, std::size_t w);

/// A scene at one wavelength with the light that it is solved for.
struct LitScene {
    LightChoice light;
    SceneOptics
        optics;  ///< of what shows; its scattering matrix where light has several components
};

/// All of it for some of the scene's wavelengths. Where scattering matrices were needed to choose,
/// numbers take moments and P from them, too: no sphere is computed twice.
std::vector<LitScene> light_and_optics(const LayerRequest& request,
                                       const std::vector<std::size_t>& wavelengths,
                                       double hiding_tolerance, OpticsDemand demand,
                                       const Control& control);

/// Writes what was chosen into a report that has been judged.
void state_light(const LightChoice& light, WavelengthReport& report);

/// Bound on what leaving polarisation out changes of R11: in proportion to albedo times the mean of
/// b1^2 over the sphere, the largest of the media (docs/polarisation.md#how-auto-decides). Without
/// boundaries.
double change_by_polarisation(const rte::Stack& stack);

/// The change by polarisation of spheres, from their size parameter alone: a bound over all
/// refractive indices.
double change_by_polarisation(double effective_size_parameter);

}  // namespace miebrdf
