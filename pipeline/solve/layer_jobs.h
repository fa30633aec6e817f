// The layers of a request as jobs: which wavelengths need solving, and what they have in common.
#pragma once

#include <string>
#include <vector>

#include "pipeline/solve/layers.h"

namespace miebrdf {

struct LayerJob {
    double wavelength_nm = 0.0;
    std::string hash;          ///< names the job: everything its slice depends on (packed_layers.h)
    std::string base_hash;     ///< names its half-space (below)
    bool closed_form = false;  ///< has_closed_form: nothing to solve
};

struct LayerJobs {
    std::vector<LayerJob> jobs;        ///< each once
    std::vector<std::size_t> serving;  ///< [wavelength of the request]: its job
};

/// @param request  its directions as the solver gets them (distinct_directions.h)
LayerJobs list_layer_jobs(const Request& request, const SceneMedia& media, LayerQuantity quantity);

/// Names the half-space that the layers of a wavelength lie on: two jobs with the same name solve
/// the same equations for it wherever they take as many nodes (their coats may ask for more or
/// fewer). Neither coats nor azimuths are part of it.
std::string base_hash(const Request& request, const SceneMedia& media, double wavelength_nm);

/// Albedos need moments only.
PhaseDemand phase_demand(LayerQuantity quantity);

}  // namespace miebrdf
