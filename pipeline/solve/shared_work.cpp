#include "pipeline/solve/shared_work.h"

#include <set>

#include "pipeline/plan/rules.h"
#include "pipeline/solve/distinct_directions.h"
#include "pipeline/solve/packed_optics.h"

namespace miebrdf {

SharedWork::SharedWork(std::int64_t limit_bytes)
    : budget_(std::make_shared<rte::MemoryBudget>(limit_bytes)) {}

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
        ++bases_[job.base_hash].expected;
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
        budget_->give_back(spheres.bytes);
        spheres_.erase(found);
    }
    return known;
}

void SharedWork::keep(const std::string& hash, const MediumOptics& optics) {
    const auto bytes = static_cast<std::int64_t>(packed(optics).size() * sizeof(double));
    const std::lock_guard lock(mutex_);
    const auto found = spheres_.find(hash);
    if (found == spheres_.end() || found->second.optics || !budget_->take(bytes)) return;
    found->second.optics = std::make_shared<const MediumOptics>(optics);
    found->second.bytes = bytes;
}

std::shared_ptr<rte::SolvedHalfSpaces> SharedWork::half_spaces(const std::string& base_hash) {
    const std::lock_guard lock(mutex_);
    const auto found = bases_.find(base_hash);
    if (found == bases_.end() || found->second.expected < 2) return nullptr;
    Base& base = found->second;
    if (!base.solved) base.solved = std::make_shared<rte::SolvedHalfSpaces>(budget_);
    return base.solved;
}

void SharedWork::leave(const std::string& base_hash) {
    const std::lock_guard lock(mutex_);
    const auto found = bases_.find(base_hash);
    if (found == bases_.end() || ++found->second.done < found->second.expected) return;
    if (found->second.solved) half_spaces_found_ += found->second.solved->found();
    bases_.erase(found);
}

int SharedWork::half_spaces_found() const {
    const std::lock_guard lock(mutex_);
    int sum = half_spaces_found_;
    for (const auto& [name, base] : bases_) sum += base.solved ? base.solved->found() : 0;
    return sum;
}

int SharedWork::optics_found() const {
    const std::lock_guard lock(mutex_);
    return optics_found_;
}

SharedBase::SharedBase(SharedWork* shared, const std::string& base_hash)
    : shared_(shared), base_hash_(base_hash) {
    if (shared_ != nullptr) solved_ = shared_->half_spaces(base_hash);
}

SharedBase::~SharedBase() {
    if (shared_ != nullptr) shared_->leave(base_hash_);
}

}  // namespace miebrdf
