#include "pipeline/solve/optics_memo.h"

#include <memory>
#include <utility>

#include "pipeline/cache/packed_numbers.h"
#include "pipeline/cache/result_cache.h"
#include "rte/boundary/rough_boundaries.h"
#include "rte/stack/layered_reflection.h"

namespace miebrdf {
std::size_t bytes_of(const MediumOptics& optics) {
    const auto* table = optics.optics.phase.target<mie::PhaseTable>();
    const std::size_t of_table =
        table == nullptr ? 0 : table->parts().coefficients.size() + 2 * table->parts().edges.size();
    const rte::Polarisation* p = optics.optics.polarisation.get();
    const std::size_t of_matrix = p == nullptr ? 0 : 5 * p->a2.size();
    return sizeof(double) * (optics.optics.chi.size() + optics.phase.size() + of_table + of_matrix);
}

std::vector<double> packed(const MediumOptics& optics) {
    // A species alone: the extinction of a medium is not its own.
    const auto& [o, phase, phase_error, asymmetry, q_ext, error_estimate, converged, per_um] =
        optics;
    static_cast<void>(per_um);
    const auto& [albedo, one_minus_albedo, chi, has_more_moments, function, polarisation] = o;
    NumberPacker packer;
    packer.add(albedo).add(one_minus_albedo).add(chi).add(has_more_moments);
    packer.add(phase).add(phase_error).add(asymmetry).add(q_ext).add(error_estimate).add(converged);
    const auto* table = function.target<mie::PhaseTable>();
    packer.add(polarisation != nullptr);
    if (polarisation != nullptr) {
        packer.add<MatrixExpansion>(*polarisation);  // Mie theory gives coefficients alone
    }
    packer.add(table != nullptr);
    if (table == nullptr) return packer.numbers();
    const auto& [edges, coefficients, mean, interpolation_error, size_error, noise, noise_floor,
                 gave_moments] = table->parts();
    packer.add(edges).add(coefficients).add(mean).add(interpolation_error).add(size_error);
    return packer.add(noise).add(noise_floor).add(gave_moments).numbers();
}

MediumOptics unpacked_optics(const std::vector<double>& numbers) {
    NumberUnpacker unpacker(numbers);
    MediumOptics optics;
    const auto read = [&](auto&... values) { (unpacker.read(values), ...); };
    rte::Optics& o = optics.optics;
    read(o.single_scattering_albedo, o.one_minus_albedo, o.chi, o.has_more_moments);
    read(optics.phase, optics.phase_error, optics.asymmetry, optics.q_ext, optics.error_estimate,
         optics.converged);
    bool has_polarisation = false;
    read(has_polarisation);
    if (has_polarisation) {
        rte::Polarisation p;
        unpacker.read<MatrixExpansion>(p);
        o.polarisation = std::make_shared<const rte::Polarisation>(std::move(p));
    }
    bool has_table = false;
    read(has_table);
    if (!has_table) return optics;
    mie::PhaseTable::Parts parts;
    read(parts.edges, parts.coefficients, parts.mean, parts.interpolation_error, parts.size_error);
    read(parts.noise, parts.noise_floor, parts.gave_moments);
    o.phase = mie::PhaseTable(std::move(parts));
    return optics;
}

OpticsMemo::OpticsMemo(std::size_t limit_bytes, std::shared_ptr<OpticsStore> shared)
    : free_bytes_(limit_bytes),
      shared_(std::move(shared)),
      rough_boundaries_(std::make_shared<rte::RoughBoundaries>()) {}

std::shared_ptr<const MediumOptics> OpticsMemo::find(const std::string& hash) {
    const std::lock_guard lock(mutex_);
    const auto known = known_.find(hash);
    if (known == known_.end()) return nullptr;
    ++found_;
    return known->second;
}

void OpticsMemo::keep(const std::string& hash, const MediumOptics& optics) {
    keep(hash, optics, bytes_of(optics));
}

void OpticsMemo::keep(const std::string& hash, const MediumOptics& optics, std::size_t bytes) {
    const std::lock_guard lock(mutex_);
    if (bytes > free_bytes_ || known_.contains(hash)) return;
    free_bytes_ -= bytes;
    known_.emplace(hash, std::make_shared<const MediumOptics>(optics));
}

std::optional<std::vector<double>> OpticsMemo::find_numbers(const std::string& hash) const {
    const std::lock_guard lock(mutex_);
    const auto known = numbers_.find(hash);
    return known == numbers_.end() ? std::nullopt : std::optional(known->second);
}

void OpticsMemo::keep_numbers(const std::string& hash, std::vector<double> numbers) {
    const std::lock_guard lock(mutex_);
    const std::size_t bytes = sizeof(double) * numbers.size();
    if (bytes > free_bytes_ || !numbers_.emplace(hash, std::move(numbers)).second) return;
    free_bytes_ -= bytes;
}

int OpticsMemo::found() const {
    const std::lock_guard lock(mutex_);
    return found_;
}

std::size_t OpticsMemo::free_bytes() const {
    const std::lock_guard lock(mutex_);
    return free_bytes_;
}

std::shared_ptr<OpticsMemo> make_optics_memo(std::size_t limit_bytes) {
    return std::make_shared<OpticsMemo>(limit_bytes);
}

rte::SolutionMemory memory_of(const Control& control) {
    if (control.memo == nullptr) return {};
    return rte::memory_with(control.memo->rough_boundaries(), control.memo->kept_layers);
}

MediumOptics remembered_optics(const Control& control, const std::string& hash,
                               const std::function<MediumOptics()>& compute) {
    if (control.memo != nullptr) {
        if (const auto known = control.memo->find(hash)) return *known;
    }
    OpticsStore* shared = control.memo != nullptr ? control.memo->shared() : nullptr;
    auto numbers = shared != nullptr ? shared->find(hash) : std::nullopt;
    if (!numbers && control.cache != nullptr) numbers = control.cache->find(hash);
    MediumOptics optics;
    if (numbers) {
        optics = unpacked_optics(*numbers);
    } else {
        optics = compute();
        if (control.cache != nullptr) control.cache->store(hash, packed(optics));
        if (shared != nullptr) shared->store(hash, packed(optics));
    }
    if (control.memo != nullptr) control.memo->keep(hash, optics);
    return optics;
}

std::vector<double> remembered_numbers(const Control& control, const std::string& hash,
                                       const std::function<std::vector<double>()>& compute) {
    auto numbers = control.memo != nullptr ? control.memo->find_numbers(hash) : std::nullopt;
    if (numbers) return *numbers;
    if (control.cache != nullptr) numbers = control.cache->find(hash);
    if (!numbers) {
        numbers = compute();
        if (control.cache != nullptr) control.cache->store(hash, *numbers);
    }
    if (control.memo != nullptr) control.memo->keep_numbers(hash, *numbers);
    return *numbers;
}

}  // namespace miebrdf
