#include "pipeline/solve/scene_optics.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include <miebrdf/error.h>
#include "pipeline/cache/result_cache.h"
#include "pipeline/plan/rules.h"
#include "pipeline/solve/packed_optics.h"
#include "pipeline/solve/parallel.h"
#include "pipeline/solve/shared_work.h"
#include "rte/math/tolerance_budget.h"

namespace miebrdf {
namespace {

// Streams that `auto` may go up to for Mie media; more would want moments that cost more than all
// the rest (docs/numerics.md).
constexpr int kMostAutomaticStreams = 64;

/// Moments that the solver can make use of: with n streams it keeps 2 n at most, and delta-M needs
/// one more.
int highest_moment(const rte::SolverOptions& options) {
    return 2 * (options.streams > 0 ? options.streams : kMostAutomaticStreams);
}

/// A job and the place its result goes to.
struct Job {
    std::size_t medium;
    double wavelength_nm;
};

/// The jobs of a request, each once, and which job serves medium i at wavelength w.
struct JobList {
    std::vector<Job> jobs;
    std::vector<std::vector<std::size_t>> serving;  ///< [wavelength][medium]
};

JobList list_jobs(const std::vector<ResolvedMedium>& media, const ParticleOptions& particles,
                  const std::vector<double>& wavelengths_nm) {
    JobList list;
    std::map<std::string, std::size_t> known;
    for (const double wavelength_nm : wavelengths_nm) {
        auto& row = list.serving.emplace_back();
        for (std::size_t i = 0; i < media.size(); ++i) {
            if (needs_mie(media[i].medium)) {
                JobKey key("spheres");
                media[i].add_to(key, wavelength_nm, particles);
                const auto [found, is_new] = known.try_emplace(key.hash(), list.jobs.size());
                row.push_back(found->second);
                if (!is_new) continue;
            } else {
                row.push_back(list.jobs.size());
            }
            list.jobs.push_back({i, wavelength_nm});
        }
    }
    return list;
}

/// Optics from where they are known: from an earlier result of the run, or from the cache.
template <typename Compute>
MediumOptics remembered(const RunControl& control, const std::string& hash,
                        const Compute& compute) {
    if (control.shared != nullptr) {
        if (const auto known = control.shared->optics(hash)) return *known;
    }
    MediumOptics optics;
    const auto numbers = control.cache != nullptr ? control.cache->find(hash) : std::nullopt;
    if (numbers) {
        optics = unpacked_optics(*numbers);
    } else {
        optics = compute();
        if (control.cache != nullptr) control.cache->store(hash, packed(optics));
    }
    if (control.shared != nullptr) control.shared->keep(hash, optics);
    return optics;
}

}  // namespace

std::string optics_hash(const ResolvedMedium& medium, double wavelength_nm,
                        const ParticleOptions& particles, const OpticsDemand& demand) {
    JobKey key("single scattering");
    medium.add_to(key, wavelength_nm, particles);
    key.add(demand.highest_moment).add(demand.whole_phase_function ? 1 : 0);
    key.add(std::span<const double>(demand.angles_deg)).add(demand.tolerance);
    return key.hash();
}

OpticsDemand demand_of(const Request& request, PhaseDemand phase) {
    const double wanted = request.scene.particles.tolerance;
    OpticsDemand demand;
    demand.tolerance = wanted > 0.0 ? wanted : kMieShare * request.solver.tolerance;
    demand.highest_moment = highest_moment(request.solver);
    demand.whole_phase_function =
        phase == PhaseDemand::whole && request.solver.single_scattering_correction;
    return demand;
}

SceneMedia::SceneMedia(const Request& request) : scene_(without_empty_coats(request.scene)) {
    MediumResolver resolver(request.database);
    media_.push_back(resolver.resolve(scene_.base));
    for (const CoatMedium& coat : scene_.coats) media_.push_back(resolver.resolve(coat.medium));
    for (const ResolvedMedium& medium : media_)
        require_contrast(medium, request.wavelength_nm, scene_.particles);
    if (!scene_.surface || scene_.surface_index) return;
    const Medium& top = top_medium(request.scene);
    if (!needs_mie(top)) {
        throw UsageError(
            fmt::format("the surface of '{}' has no refractive index; give one with "
                        "--surface-index N,K, or leave "
                        "the surface out with --roughness 0",
                        describe(top)));
    }
    surface_medium_ = resolver.resolve(top);
}

SceneMedia SceneMedia::from_coat(std::size_t coat) const {
    const auto position = static_cast<std::ptrdiff_t>(coat);
    SceneMedia upper = *this;
    upper.scene_.base = scene_.coats[coat].medium;
    upper.scene_.coats.erase(upper.scene_.coats.begin(), upper.scene_.coats.begin() + position + 1);
    upper.media_.erase(upper.media_.begin(), upper.media_.begin() + position + 1);
    return upper;
}

SceneMedia SceneMedia::below_coat(std::size_t coat) const {
    SceneMedia lower = *this;
    lower.scene_.coats.resize(coat);
    lower.media_.resize(coat + 1);
    return lower;
}

std::vector<std::string> SceneMedia::sources() const {
    std::vector<std::string> lines;
    const auto add = [&](const ResolvedMedium& medium) {
        if (std::find(lines.begin(), lines.end(), medium.source) == lines.end()) {
            lines.push_back(medium.source);
        }
    };
    for (const ResolvedMedium& medium : media_) add(medium);
    if (surface_medium_) add(*surface_medium_);
    return lines;
}

std::complex<double> SceneMedia::surface_index_at(double wavelength_nm) const {
    if (scene_.surface_index) return *scene_.surface_index;
    return *surface_medium_->index_at(wavelength_nm, scene_.particles.k_floor);
}

void SceneMedia::add_to(JobKey& key, double wavelength_nm) const {
    for (std::size_t i = 0; i < media_.size(); ++i) {
        if (i > 0) key.add(scene_.coats[i - 1].optical_depth);
        media_[i].add_to(key, wavelength_nm, scene_.particles);
    }
}

std::vector<SceneOptics> SceneMedia::optics(const std::vector<double>& wavelength_nm,
                                            const OpticsDemand& demand,
                                            const RunControl& control) const {
    const JobList list = list_jobs(media_, scene_.particles, wavelength_nm);
    std::vector<MediumOptics> done(list.jobs.size());
    const mie::Executor pieces = pieces_of_job(control);
    run_parallel("single scattering", list.jobs.size(), control, [&](std::size_t j) {
        const Job& job = list.jobs[j];
        const ResolvedMedium& medium = media_[job.medium];
        const auto compute = [&] {
            return medium_optics(medium, job.wavelength_nm, scene_.particles, demand, pieces);
        };
        done[j] = needs_mie(medium.medium)
                      ? remembered(control,
                                   optics_hash(medium, job.wavelength_nm, scene_.particles, demand),
                                   compute)
                      : compute();
    });

    std::vector<SceneOptics> scenes;
    for (const std::vector<std::size_t>& serving : list.serving) {
        SceneOptics& scene = scenes.emplace_back();
        for (std::size_t i = 0; i < media_.size(); ++i) {
            const MediumOptics& optics = done[serving[i]];
            if (i == 0) {
                scene.stack.base = optics.optics;
            } else {
                scene.stack.coats.push_back({optics.optics, scene_.coats[i - 1].optical_depth});
            }
            scene.mie_error_estimate = std::max(scene.mie_error_estimate, optics.error_estimate);
            scene.converged = scene.converged && optics.converged;
        }
    }
    return scenes;
}

}  // namespace miebrdf
