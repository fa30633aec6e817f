// Which layers can be seen from above: what lies below a coat that hides it is not computed.
#pragma once

#include <miebrdf/optics.h>
#include "pipeline/solve/scene_optics.h"

namespace miebrdf {

/// Optics of the layers that show, at each wavelength: a coat that hides what is below becomes the
/// half-space, and single scattering below it is never computed.
std::vector<SceneOptics> visible_optics(const SceneMedia& media, const Request& request,
                                        const std::vector<double>& wavelength_nm,
                                        const OpticsDemand& demand, const RunControl& control);

}  // namespace miebrdf
