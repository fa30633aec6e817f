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
#include "pipeline/solve/packing.h"
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

mie::EnsembleRequest ensemble_request(const ResolvedSpecies& species, std::size_t w,
                                      const OpticsDemand& demand) {
    const Particles& at = species.particles[w];
    mie::EnsembleRequest request;
    request.sizes = species.sizes;
    request.refractive_index = at.index;
    request.host_index = at.host_index;
    request.wavelength_nm = at.wavelength_nm;
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
mie::EnsembleOptics average(const Species& species, const mie::EnsembleRequest& request,
                            const mie::Executor& run) {
    try {
        return mie::average_over_sizes(request, run);
    } catch (const UsageError& error) {
        const ParticleSizes& own = species.sizes;
        throw UsageError(fmt::format(
            "medium '{}': {} ({}, {} {}, host_index {}, at {} nm)", describe(species), error.what(),
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

/// The structure factor is multiplied with the whole phase function, even where moments are all
/// that is wanted.
OpticsDemand crowd_demand(const ResolvedSpecies& species, OpticsDemand demand) {
    demand.whole_phase_function = demand.whole_phase_function || species.crowded;
    return demand;
}

/// Species at a wavelength.
struct Job {
    const ResolvedSpecies* species;
    std::size_t wavelength;
};

/// Jobs, each once, found by what they depend on.
class JobList {
  public:
    /// The number of the job.
    std::size_t add(const ResolvedSpecies& species, std::size_t w) {
        const std::string name = species.crowded
                                     ? fmt::format("{} {}", species.key[w], species.volume_fraction)
                                     : species.key[w];
        const auto [found, is_new] = known_.try_emplace(name, jobs_.size());
        if (is_new) jobs_.push_back({&species, w});
        return found->second;
    }

    std::vector<std::size_t> add(const ResolvedMedium& medium, std::size_t w) {
        std::vector<std::size_t> all;
        for (const ResolvedSpecies& species : medium.species) all.push_back(add(species, w));
        return all;
    }

    /// The results, job by job.
    std::vector<MediumOptics> compute(const OpticsDemand& of_all, const Control& control) const {
        std::vector<MediumOptics> done(jobs_.size());
        const mie::Executor pieces = pieces_of_job(control);
        run_parallel("single scattering", jobs_.size(), control, [&](std::size_t j) {
            const auto [species, w] = jobs_[j];
            const OpticsDemand demand = crowd_demand(*species, of_all);
            const auto compute = [&, species = species, w = w] {
                return compute_optics(*species, w, demand, pieces);
            };
            done[j] = species->needs_mie()
                          ? remembered(control, optics_hash(*species, w, demand), compute)
                          : compute();
            if (species->crowded) done[j] = crowded(done[j], *species, w, demand.angles_deg);
        });
        return done;
    }

  private:
    std::map<std::string, std::size_t> known_;
    std::vector<Job> jobs_;
};

std::vector<MediumOptics> chosen(const std::vector<MediumOptics>& all,
                                 const std::vector<std::size_t>& which) {
    std::vector<MediumOptics> some;
    for (const std::size_t i : which) some.push_back(all[i]);
    return some;
}

/// Matter of albedo 0.
MediumOptics absorber() {
    MediumOptics optics;
    optics.optics.single_scattering_albedo = 0.0;
    optics.optics.one_minus_albedo = 1.0;
    return optics;
}

/// 3 f Q_ext / (4 r_eff).
double extinction_of(const ResolvedSpecies& species, const MediumOptics& optics) {
    return 0.75 * species.volume_fraction * optics.q_ext.value_or(0.0) /
           species.effective_radius_um;
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

std::string optics_hash(const ResolvedSpecies& species, std::size_t w, const OpticsDemand& demand) {
    const auto& [highest_moment, whole, angles_deg, tolerance] = demand;
    JobKey key("single scattering");
    key.add(std::string_view(species.key[w]));
    // With the whole phase function come all moments, however few were asked for.
    return key.add(whole ? -1 : highest_moment).add(whole).add(angles_deg).add(tolerance).hash();
}

MediumOptics compute_optics(const ResolvedSpecies& species, std::size_t w,
                            const OpticsDemand& demand, const mie::Executor& run) {
    if (species.needs_mie()) {
        const auto request = ensemble_request(species, w, demand);
        return from_mie(average(species.species, request, run), request);
    }
    MediumOptics result;
    result.optics = kind_of(species.species).optics(species.species);
    result.asymmetry = result.optics.chi.size() > 1 ? result.optics.chi[1] : 0.0;
    for (const double angle : demand.angles_deg) {
        result.phase.push_back(
            rte::exact_phase(result.optics, std::cos(angle * std::numbers::pi / 180.0)));
        result.phase_error.push_back(0.0);
    }
    return result;
}

double extinction_per_um(const ResolvedMedium& medium, std::size_t w,
                         const std::vector<MediumOptics>& species) {
    if (!medium.needs_mie()) return 0.0;
    double sum = medium.host_absorption[w];
    for (std::size_t s = 0; s < species.size(); ++s)
        sum += extinction_of(medium.species[s], species[s]);
    return sum;
}

MediumOptics mixed(const ResolvedMedium& medium, std::size_t w,
                   const std::vector<MediumOptics>& species) {
    const double host = medium.host_absorption[w];
    MediumOptics whole = species.front();
    whole.extinction_per_um = extinction_per_um(medium, w, species);
    if (species.size() == 1 && host == 0.0) return whole;  // one species: no mixing
    std::vector<rte::MixtureComponent> components;
    std::vector<double> scattering;
    double sum = 0.0;
    for (std::size_t s = 0; s < species.size(); ++s) {
        const double extinction = extinction_of(medium.species[s], species[s]);
        components.push_back({species[s].optics, extinction});
        scattering.push_back(extinction * species[s].optics.single_scattering_albedo);
        sum += scattering.back();
        whole.error_estimate = std::max(whole.error_estimate, species[s].error_estimate);
        whole.converged = whole.converged && species[s].converged;
    }
    if (host > 0.0) components.push_back({absorber().optics, host});
    whole.optics = rte::mix(components);
    whole.q_ext.reset();
    whole.asymmetry = 0.0;
    std::fill(whole.phase.begin(), whole.phase.end(), 0.0);
    std::fill(whole.phase_error.begin(), whole.phase_error.end(), 0.0);
    for (std::size_t s = 0; s < species.size() && sum > 0.0; ++s) {
        const double share = scattering[s] / sum;
        whole.asymmetry += share * species[s].asymmetry;
        for (std::size_t a = 0; a < whole.phase.size(); ++a)
            whole.phase[a] += share * species[s].phase[a];
        for (std::size_t a = 0; a < species[s].phase_error.size(); ++a)
            whole.phase_error[a] += share * species[s].phase_error[a];
    }
    return whole;
}

MediumOptics compute_optics(const ResolvedScene& scene, std::size_t medium, std::size_t w,
                            const OpticsDemand& demand, const mie::Executor& run) {
    const ResolvedMedium& resolved = scene.media[medium];
    std::vector<MediumOptics> species;
    for (const ResolvedSpecies& one : resolved.species) {
        const OpticsDemand of_species = crowd_demand(one, demand);
        species.push_back(compute_optics(one, w, of_species, run));
        if (one.crowded) species.back() = crowded(species.back(), one, w, demand.angles_deg);
    }
    return mixed(resolved, w, species);
}

mie::PhaseValues phase_of_mie(const ResolvedSpecies& species, std::size_t w,
                              const OpticsDemand& demand, const mie::PhaseTable& table,
                              const std::vector<double>& angles_deg,
                              const std::vector<double>& allowed, const mie::Executor& run) {
    auto request = ensemble_request(species, w, demand);
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
    JobList list;
    std::vector<std::vector<std::size_t>> jobs;  // [wavelength and medium][species]
    for (const std::size_t w : wavelengths) {
        for (const std::size_t m : media) jobs.push_back(list.add(scene.media[m], w));
    }
    const std::vector<MediumOptics> done = list.compute(demand, control);
    std::vector<std::vector<MediumOptics>> all;
    auto next = jobs.begin();
    for (const std::size_t w : wavelengths) {
        auto& row = all.emplace_back();
        for (const std::size_t m : media)
            row.push_back(mixed(scene.media[m], w, chosen(done, *next++)));
    }
    return all;
}

std::vector<std::vector<double>> optical_depths_of(const ResolvedScene& scene,
                                                   const std::vector<std::size_t>& wavelengths,
                                                   double mie_tolerance, const Control& control) {
    OpticsDemand demand;
    demand.tolerance = mie_tolerance;
    struct Following {
        std::size_t place, layer;
        std::vector<std::size_t> here, reference;
    };
    JobList list;
    std::vector<Following> following;
    std::vector<std::vector<double>> depths(wavelengths.size());
    for (std::size_t place = 0; place < wavelengths.size(); ++place) {
        const std::size_t w = wavelengths[place];
        for (std::size_t layer = 0; layer < scene.layers(); ++layer) {
            const ResolvedDepth& depth = scene.depths[layer];
            depths[place].push_back(depth.optical_depth);
            const bool is_there =
                depth.reference && depth.depth.wavelength_nm == scene.wavelength_nm[w];
            if (depth.is_grey() || is_there) continue;
            following.push_back({place, layer, list.add(scene.media[layer + 1], w), {}});
            if (depth.reference) following.back().reference = list.add(*depth.reference, 0);
        }
    }
    const std::vector<MediumOptics> done = list.compute(demand, control);
    for (const Following& f : following) {
        const ResolvedDepth& depth = scene.depths[f.layer];
        const double here =
            extinction_per_um(scene.media[f.layer + 1], wavelengths[f.place], chosen(done, f.here));
        depths[f.place][f.layer] =
            depth.column_um ? *depth.column_um * here
                            : depth.optical_depth * here /
                                  extinction_per_um(*depth.reference, 0, chosen(done, f.reference));
    }
    return depths;
}

std::vector<double> packed(const MediumOptics& optics) {
    // A species alone: the extinction of a medium is not its own.
    const auto& [o, phase, phase_error, asymmetry, q_ext, error_estimate, converged, per_um] =
        optics;
    static_cast<void>(per_um);
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

std::size_t OpticsMemo::free_bytes() const {
    const std::lock_guard lock(mutex_);
    return free_bytes_;
}

std::shared_ptr<OpticsMemo> make_optics_memo(std::size_t limit_bytes) {
    return std::make_shared<OpticsMemo>(limit_bytes);
}

}  // namespace miebrdf
