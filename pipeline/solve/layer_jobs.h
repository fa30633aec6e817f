// The layers of a request as jobs: which wavelengths need solving, and what they have in common.
#pragma once

#include <string>
#include <vector>

#include "pipeline/solve/layers.h"

namespace miebrdf {

struct LayerJob {
    double wavelength_nm = 0.0;
    std::string hash;          ///< names the job: everything its slice depends on (packed_layers.h)
    bool closed_form = false;  ///< has_closed_form: nothing to solve
};

struct LayerJobs {
    std::vector<LayerJob> jobs;        ///< each once
    std::vector<std::size_t> serving;  ///< [wavelength of the request]: its job
};

/// @param request  its directions as the solver gets them (distinct_directions.h)
LayerJobs list_layer_jobs(const Request& request, const SceneMedia& media, LayerQuantity quantity);

/// Albedos need moments only.
PhaseDemand phase_demand(LayerQuantity quantity);

}  // namespace miebrdf
