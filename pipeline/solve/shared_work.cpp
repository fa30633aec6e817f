#include "pipeline/solve/shared_work.h"

#include <set>

#include "pipeline/plan/rules.h"
#include "pipeline/solve/distinct_directions.h"
#include "pipeline/solve/packed_optics.h"

namespace miebrdf {

SharedWork::SharedWork(std::int64_t limit_bytes) : free_bytes_(limit_bytes) {}

void SharedWork::expect(const Request& request, LayerQuantity quantity) {
    validate(request);
    if (quantity == LayerQuantity::reflection && !wants_layers(request.parts)) return;
    const SceneMedia media(request);
    Request reduced = request;
    reduced.directions = DistinctDirections(request.directions).directions();
    expect(reduced, media, quantity, list_layer_jobs(reduced, media, quantity));
}

void SharedWork::expect(const Request& request, const SceneMedia& media, LayerQuantity quantity,
                        const LayerJobs& jobs) {
    const OpticsDemand demand = demand_of(request, phase_demand(quantity));
    std::set<std::string> spheres;  // a result asks for each of them once
    const std::lock_guard lock(mutex_);
    for (const LayerJob& job : jobs.jobs) {
        if (job.closed_form) continue;
        for (const ResolvedMedium& medium : media.media()) {
            if (!needs_mie(medium.medium)) continue;
            spheres.insert(optics_hash(medium, job.wavelength_nm, request.scene.particles, demand));
        }
    }
    for (const std::string& hash : spheres) ++spheres_[hash].to_come;
}

std::shared_ptr<const MediumOptics> SharedWork::optics(const std::string& hash) {
    const std::lock_guard lock(mutex_);
    const auto found = spheres_.find(hash);
    if (found == spheres_.end()) return nullptr;
    Spheres& spheres = found->second;
    --spheres.to_come;
    std::shared_ptr<const MediumOptics> known = spheres.optics;
    if (known) ++optics_found_;
    if (spheres.to_come <= 0) {
        free_bytes_ += spheres.bytes;
        spheres_.erase(found);
    }
    return known;
}

void SharedWork::keep(const std::string& hash, const MediumOptics& optics) {
    const auto bytes = static_cast<std::int64_t>(packed(optics).size() * sizeof(double));
    const std::lock_guard lock(mutex_);
    const auto found = spheres_.find(hash);
    if (found == spheres_.end() || found->second.optics || bytes > free_bytes_) return;
    free_bytes_ -= bytes;
    found->second.optics = std::make_shared<const MediumOptics>(optics);
    found->second.bytes = bytes;
}

std::int64_t SharedWork::free_bytes() const {
    const std::lock_guard lock(mutex_);
    return free_bytes_;
}

int SharedWork::optics_found() const {
    const std::lock_guard lock(mutex_);
    return optics_found_;
}

}  // namespace miebrdf
