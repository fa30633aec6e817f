#include "pipeline/solve/layer_jobs.h"

#include <map>

#include "pipeline/solve/packed_layers.h"

namespace miebrdf {

LayerJobs list_layer_jobs(const Request& request, const SceneMedia& media, LayerQuantity quantity) {
    LayerJobs list;
    std::map<std::string, std::size_t> known;
    for (const double wavelength_nm : request.wavelength_nm) {
        std::string hash = layer_hash(request, media, quantity, wavelength_nm);
        const auto [found, is_new] = known.try_emplace(hash, list.jobs.size());
        list.serving.push_back(found->second);
        if (!is_new) continue;
        list.jobs.push_back(
            {wavelength_nm, std::move(hash), has_closed_form(media, quantity, wavelength_nm)});
    }
    return list;
}

PhaseDemand phase_demand(LayerQuantity quantity) {
    return quantity == LayerQuantity::reflection ? PhaseDemand::whole : PhaseDemand::moments_only;
}

}  // namespace miebrdf
