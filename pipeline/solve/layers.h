// The layers of a scene without its surface, wavelength by wavelength: what is remembered is looked
// up, the rest goes through Mie theory and radiative transfer.
#pragma once

#include <vector>

#include "pipeline/scene/request.h"
#include "pipeline/solve/phase_noise.h"
#include "pipeline/solve/run_control.h"
#include "pipeline/solve/scene_optics.h"
#include "rte/stack/layered_reflection.h"

namespace miebrdf {

enum class LayerQuantity {
    reflection,  ///< R at all combinations of the request's directions
    albedo,      ///< plane albedo at the request's mu_in, then the spherical albedo
    /// The same of the light that the request's surface lets in, and of what it lets out again
    /// (rte::SurfaceTransmission).
    albedo_through_surface,
};

/// What an albedo request needs of the layers.
LayerQuantity albedo_quantity(const Scene& scene);

struct LayerSlice {
    std::vector<double> values;        ///< laid out as in rte::ReflectionTable, or as said above
    std::vector<double> plane_albedo;  ///< at the request's mu_in, with `reflection` too
    double mie_error_estimate = 0.0;
    PhaseNoise phase_noise;  ///< see largest_phase_noise; of `reflection` only
    rte::SolverReport report;
    double error_estimate = 0.0;  ///< of both steps together
    bool converged = false;       ///< every step reached its tolerance
};

/// One slice for each of Request::wavelength_nm; wavelengths whose layers are the same (repeated,
/// or of media that do not change with it) are computed once. With control.cache, slices are stored
/// as soon as they are known: a run that is stopped keeps what it has done.
/// @throws UsageError, InputError, Cancelled
std::vector<LayerSlice> compute_layers(const Request& request, const SceneMedia& media,
                                       LayerQuantity quantity, const RunControl& control);

/// Whether the answer is known without solving anything: albedos of layers that absorb nothing.
bool has_closed_form(const SceneMedia& media, LayerQuantity quantity, double wavelength_nm);

}  // namespace miebrdf
