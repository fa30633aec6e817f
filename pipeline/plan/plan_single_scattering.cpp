#include <fmt/format.h>

#include <map>
#include <set>

#include "pipeline/plan/cost_model.h"
#include "pipeline/plan/planner.h"

namespace miebrdf {

void Planner::single_scattering() {
    if (jobs_nm_.empty()) return;
    std::vector<Medium> layers{visible_.base};
    for (const CoatMedium& coat : visible_.coats) layers.push_back(coat.medium);
    std::set<std::string> given;
    std::map<std::string, std::size_t> count;
    double repeated_s = 0.0, cached_s = 0.0;
    std::size_t repeated = 0, cached = 0;
    const OpticsDemand demand = demand_of(reduced_, phase_demand(quantity_));
    MediumResolver resolver(request_.database);
    for (const Medium& layer : layers) {
        const ResolvedMedium medium = resolver.resolve(layer);
        if (!needs_mie(layer)) {
            given.insert(describe(layer));
            continue;
        }
        for (const double wavelength_nm : jobs_nm_) {
            const std::string hash =
                optics_hash(medium, wavelength_nm, request_.scene.particles, demand);
            if (!earlier_.optics.insert(hash).second) {
                ++repeated;
                repeated_s += mie_cost(layer, wavelength_nm);
            } else if (cache_ != nullptr && cache_->find(hash)) {
                ++cached;
                cached_s += mie_cost(layer, wavelength_nm);
            } else {
                ++count[describe(layer)];
            }
        }
    }
    for (const auto& [name, jobs] : count) {
        plan_.steps.push_back(
            {"single scattering",
             fmt::format("Mie theory for {}, tolerance {:g}{}", name, demand.tolerance,
                         whole_phase_ ? ", every angle" : ", moments only"),
             jobs, mie_cost(parse_medium(name))});
    }
    for (const std::string& name : given) {
        leave_out("analytic medium", fmt::format("{} is given: no Mie theory", name),
                  jobs() * mie_seconds(request_.scene.particles, jobs_nm_.front(), whole_phase_));
    }
    if (repeated > 0) {
        leave_out("same spheres",
                  fmt::format("{} with index, wavelength and sizes of others before",
                              counted(repeated, "Mie run")),
                  repeated_s);
    }
    if (cached > 0) {
        leave_out("in the cache", fmt::format("{} from the cache", counted(cached, "Mie run")),
                  cached_s);
    }
    if (whole_phase_ || count.empty()) return;
    double full = 0.0;
    for (const auto& [name, jobs] : count) full += phase_function_cost(parse_medium(name));
    leave_out_phase_functions(full);
}

double Planner::phase_function_cost(const Medium& medium) const {
    const ParticleOptions particles = particles_of(medium, request_.scene.particles);
    double sum = 0.0;
    for (const double nm : jobs_nm_)
        sum += mie_seconds(particles, nm, true) - mie_seconds(particles, nm, false);
    return sum;
}

void Planner::leave_out_phase_functions(double saved_s) {
    const int moments = demand_of(reduced_, phase_demand(quantity_)).highest_moment;
    leave_out(
        "few moments",
        fmt::format("no phase function at every angle; {} moments, no more than {} streams use",
                    moments, moments / 2),
        saved_s);
}

}  // namespace miebrdf
