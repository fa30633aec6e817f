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
        list.jobs.push_back({wavelength_nm, std::move(hash),
                             base_hash(request, media, wavelength_nm),
                             has_closed_form(media, quantity, wavelength_nm)});
    }
    return list;
}

std::string base_hash(const Request& request, const SceneMedia& media, double wavelength_nm) {
    const rte::SolverOptions& solver = request.solver;
    const ParticleOptions& particles = request.scene.particles;
    JobKey key("half-space");
    media.media().front().add_to(key, wavelength_nm, particles);
    key.add(particles.tolerance).add(solver.tolerance);
    key.add(static_cast<int>(solver.grid)).add(solver.streams);
    key.add(static_cast<int>(solver.half_space_method)).add(solver.delta_m ? 1 : 0);
    key.add(solver.single_scattering_correction ? 1 : 0);  // decides how many moments are known
    key.add(std::span<const double>(request.directions.mu_in));
    key.add(std::span<const double>(request.directions.mu_out));
    return key.hash();
}

PhaseDemand phase_demand(LayerQuantity quantity) {
    return quantity == LayerQuantity::reflection ? PhaseDemand::whole : PhaseDemand::moments_only;
}

}  // namespace miebrdf
