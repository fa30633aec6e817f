// The layers of a scene without its surface, wavelength by wavelength: what is remembered is looked
// up, the rest goes through Mie theory and radiative transfer.
#pragma once

#include <vector>

#include "pipeline/request.h"
#include "pipeline/run_control.h"
#include "pipeline/scene_optics.h"
#include "rte/layered_reflection.h"

namespace miebrdf {

enum class LayerQuantity {
    reflection,  ///< R at all combinations of the request's directions
    albedo,      ///< plane albedo at the request's mu_in, then the spherical albedo
};

struct LayerSlice {
    std::vector<double> values;  ///< laid out as in rte::ReflectionTable, or as said above
    double mie_error_estimate = 0.0;
    rte::SolverReport report;
    double error_estimate = 0.0;  ///< of both steps together
    bool converged = false;       ///< every step reached its tolerance
};

/// One slice for each of Request::wavelength_nm. With control.cache, slices are stored as soon as
/// they are known: a run that is stopped keeps what it has done.
/// @throws UsageError, InputError, Cancelled
std::vector<LayerSlice> compute_layers(const Request& request, const SceneMedia& media,
                                       LayerQuantity quantity, const RunControl& control);

}  // namespace miebrdf
