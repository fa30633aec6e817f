#include "pipeline/solve/single_scattering.h"

#include <fmt/format.h>
#include <miebrdf/error.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include <miebrdf/ensemble.h>
#include "pipeline/cache/job_key.h"
#include "pipeline/cache/packed_numbers.h"
#include "pipeline/cache/result_cache.h"
#include "pipeline/scene/medium_kinds.h"
#include "pipeline/solve/parallel.h"
#include "rte/first_order/first_order.h"
#include "rte/math/tolerance_budget.h"

namespace miebrdf {
namespace {

// Streams that `auto` may go up to for Mie media; more would want moments that cost more than all
// the rest (docs/numerics.md).
constexpr int kMostAutomaticStreams = 64;

/// Where P is below half of its mean over the sphere, noise is judged against that: single
/// scattering R = P / (4 (mu + mu')) of such angles is small beside the largest value at any
/// incidence.
constexpr double kPhaseFloor = 0.5;

/// Products of partial waves and angles that a level of sizes for single angles of P is worth.
constexpr double kMostPhaseWork = 3e8;

mie::EnsembleRequest ensemble_request(const ResolvedScene& scene, const ResolvedMedium& medium,
                                      std::size_t w, const OpticsDemand& demand) {
    mie::EnsembleRequest request;
    request.sizes = medium.sizes;
    request.refractive_index = medium.index[w];
    request.host_index = scene.particles.host_index;
    request.wavelength_nm = scene.wavelength_nm[w];
    request.highest_moment = demand.highest_moment;
    request.angles_deg = demand.angles_deg;
    request.tolerance = demand.tolerance;
    request.phase_tolerance =
        std::clamp(kPhasePerMoment * demand.tolerance, kLeastAngleTolerance, kMostPhaseTolerance);
    if (demand.whole_phase_function) {
        request.with_phase_table = true;
        request.phase_floor = kPhaseFloor;
        request.phase_tolerance = std::clamp(kPhasePerMoment * demand.tolerance,
                                             kLeastPhaseTolerance, kMostPhaseTolerance);
        request.table_tolerance = kPhaseInterpolationShare * request.phase_tolerance;
        request.highest_moment = std::min(mie::highest_moment_of(request), kMostMoments);
    }
    return request;
}

/// The average; what it refuses is a matter of sizes and wavelength together.
mie::EnsembleOptics average(const Medium& medium, const mie::EnsembleRequest& request,
                            const mie::Executor& run) {
    try {
        return mie::average_over_sizes(request, run);
    } catch (const UsageError& error) {
        const ParticleSizes& own = medium.sizes;
        throw UsageError(fmt::format(
            "medium '{}': {} ({}, {} {}, host_index {}, at {} nm)", describe(medium), error.what(),
            own.effective_radius_um
                ? fmt::format("radius {} um", *own.effective_radius_um)
                : fmt::format("effective_radius_um {}", request.sizes.effective_radius_um),
            own.effective_variance ? "variance" : "effective_variance",
            request.sizes.effective_variance, request.host_index, request.wavelength_nm));
    }
}

MediumOptics from_mie(const mie::EnsembleOptics& ensemble, const mie::EnsembleRequest& request) {
    MediumOptics result;
    result.optics.single_scattering_albedo = ensemble.single_scattering_albedo;
    result.optics.one_minus_albedo = ensemble.one_minus_albedo;
    if (!ensemble.chi.empty()) {
        result.optics.chi = ensemble.chi;
        result.optics.has_more_moments = request.highest_moment < mie::highest_moment_of(request);
    }
    if (ensemble.phase_table) result.optics.phase = *ensemble.phase_table;
    result.phase = ensemble.phase;
    result.phase_error = ensemble.phase_error;
    result.asymmetry = ensemble.asymmetry;
    result.q_ext = ensemble.q_ext;
    result.error_estimate = ensemble.error_estimate;
    result.converged = ensemble.converged;
    return result;
}

/// Optics from where they are known: from an earlier scene of the run, or from the cache.
template <typename Compute>
MediumOptics remembered(const Control& control, const std::string& hash, const Compute& compute) {
    if (control.memo != nullptr) {
        if (const auto known = control.memo->find(hash)) return *known;
    }
    MediumOptics optics;
    const auto numbers = control.cache != nullptr ? control.cache->find(hash) : std::nullopt;
    if (numbers) {
        optics = unpacked_optics(*numbers);
    } else {
        optics = compute();
        if (control.cache != nullptr) control.cache->store(hash, packed(optics));
    }
    if (control.memo != nullptr) control.memo->keep(hash, optics);
    return optics;
}

/// A job and the place its result goes to.
struct Job {
    std::size_t medium;
    std::size_t wavelength;
};

/// The jobs, each once, and which of them serves each wavelength and medium.
struct JobList {
    std::vector<Job> jobs;
    std::vector<std::vector<std::size_t>> serving;  ///< [place in wavelengths][medium]
};

JobList list_jobs(const ResolvedScene& scene, const std::vector<std::size_t>& media,
                  const std::vector<std::size_t>& wavelengths) {
    JobList list;
    std::map<std::string, std::size_t> known;
    for (const std::size_t w : wavelengths) {
        auto& row = list.serving.emplace_back();
        for (const std::size_t m : media) {
            const auto [found, is_new] = known.try_emplace(scene.media[m].key[w], list.jobs.size());
            row.push_back(found->second);
            if (is_new) list.jobs.push_back({m, w});
        }
    }
    return list;
}

std::size_t bytes_of(const MediumOptics& optics) {
    const auto* table = optics.optics.phase.target<mie::PhaseTable>();
    const std::size_t of_table =
        table == nullptr ? 0 : table->parts().coefficients.size() + 2 * table->parts().edges.size();
    return sizeof(double) * (optics.optics.chi.size() + optics.phase.size() + of_table);
}

}  // namespace

OpticsDemand demand_of(const rte::SolverOptions& solver, double mie_tolerance, PhaseDemand phase) {
    OpticsDemand demand;
    demand.tolerance = mie_tolerance > 0.0 ? mie_tolerance : kMieShare * solver.tolerance;
    // With n streams the solver keeps 2 n moments at most, and delta-M needs one more.
    demand.highest_moment = 2 * (solver.streams > 0 ? solver.streams : kMostAutomaticStreams);
    demand.whole_phase_function =
        phase == PhaseDemand::whole && solver.single_scattering_correction;
    return demand;
}

std::string optics_hash(const ResolvedMedium& medium, std::size_t w, const OpticsDemand& demand) {
    const auto& [highest_moment, whole, angles_deg, tolerance] = demand;
    JobKey key("single scattering");
    key.add(std::string_view(medium.key[w]));
    return key.add(highest_moment).add(whole).add(angles_deg).add(tolerance).hash();
}

MediumOptics compute_optics(const ResolvedScene& scene, std::size_t medium, std::size_t w,
                            const OpticsDemand& demand, const mie::Executor& run) {
    const ResolvedMedium& resolved = scene.media[medium];
    if (resolved.needs_mie()) {
        const auto request = ensemble_request(scene, resolved, w, demand);
        return from_mie(average(resolved.medium, request, run), request);
    }
    MediumOptics result;
    result.optics = kind_of(resolved.medium).optics(resolved.medium);
    result.asymmetry = result.optics.chi.size() > 1 ? result.optics.chi[1] : 0.0;
    for (const double angle : demand.angles_deg) {
        result.phase.push_back(
            rte::exact_phase(result.optics, std::cos(angle * std::numbers::pi / 180.0)));
        result.phase_error.push_back(0.0);
    }
    return result;
}

mie::PhaseValues phase_of_mie(const ResolvedScene& scene, std::size_t medium, std::size_t w,
                              const OpticsDemand& demand, const mie::PhaseTable& table,
                              const std::vector<double>& angles_deg,
                              const std::vector<double>& allowed, const mie::Executor& run) {
    auto request = ensemble_request(scene, scene.media[medium], w, demand);
    request.angles_deg = angles_deg;
    request.phase_allowed = allowed;
    request.phase_floor = 0.0;
    request.phase_work = kMostPhaseWork;
    for (std::size_t i = 0; i < angles_deg.size(); ++i) {
        const double P = table(std::cos(angles_deg[i] * std::numbers::pi / 180.0));
        if (P > 0.0 && allowed[i] > 0.0)
            request.phase_tolerance = std::min(request.phase_tolerance, allowed[i] / P);
    }
    request.phase_tolerance = std::max(request.phase_tolerance, kLeastAngleTolerance);
    return mie::phase_at_angles(request, 0.0, run);
}

std::vector<std::vector<MediumOptics>> optics_of(const ResolvedScene& scene,
                                                 const std::vector<std::size_t>& media,
                                                 const std::vector<std::size_t>& wavelengths,
                                                 const OpticsDemand& demand,
                                                 const Control& control) {
    const JobList list = list_jobs(scene, media, wavelengths);
    std::vector<MediumOptics> done(list.jobs.size());
    const mie::Executor pieces = pieces_of_job(control);
    run_parallel("single scattering", list.jobs.size(), control, [&](std::size_t j) {
        const auto [medium, w] = list.jobs[j];
        const auto compute = [&, m = medium, w = w] {
            return compute_optics(scene, m, w, demand, pieces);
        };
        done[j] = scene.media[medium].needs_mie()
                      ? remembered(control, optics_hash(scene.media[medium], w, demand), compute)
                      : compute();
    });
    std::vector<std::vector<MediumOptics>> all;
    for (const std::vector<std::size_t>& serving : list.serving) {
        auto& row = all.emplace_back();
        for (const std::size_t job : serving) row.push_back(done[job]);
    }
    return all;
}

std::vector<double> packed(const MediumOptics& optics) {
    const auto& [o, phase, phase_error, asymmetry, q_ext, error_estimate, converged] = optics;
    const auto& [albedo, one_minus_albedo, chi, has_more_moments, function] = o;
    NumberPacker packer;
    packer.add(albedo).add(one_minus_albedo).add(chi).add(has_more_moments);
    packer.add(phase).add(phase_error).add(asymmetry).add(q_ext).add(error_estimate).add(converged);
    const auto* table = function.target<mie::PhaseTable>();
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
    bool has_table = false;
    read(has_table);
    if (!has_table) return optics;
    mie::PhaseTable::Parts parts;
    read(parts.edges, parts.coefficients, parts.mean, parts.interpolation_error, parts.size_error);
    read(parts.noise, parts.noise_floor, parts.gave_moments);
    o.phase = mie::PhaseTable(std::move(parts));
    return optics;
}

std::shared_ptr<const MediumOptics> OpticsMemo::find(const std::string& hash) {
    const std::lock_guard lock(mutex_);
    const auto known = known_.find(hash);
    if (known == known_.end()) return nullptr;
    ++found_;
    return known->second;
}

void OpticsMemo::keep(const std::string& hash, const MediumOptics& optics) {
    const std::size_t bytes = bytes_of(optics);
    const std::lock_guard lock(mutex_);
    if (bytes > free_bytes_ || known_.contains(hash)) return;
    free_bytes_ -= bytes;
    known_.emplace(hash, std::make_shared<const MediumOptics>(optics));
}

int OpticsMemo::found() const {
    const std::lock_guard lock(mutex_);
    return found_;
}

std::shared_ptr<OpticsMemo> make_optics_memo(std::size_t limit_bytes) {
    return std::make_shared<OpticsMemo>(limit_bytes);
}

}  // namespace miebrdf
