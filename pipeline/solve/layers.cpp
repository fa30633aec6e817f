#include "pipeline/solve/layers.h"

#include <oneapi/tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <tuple>

#include <miebrdf/surface.h>
#include "pipeline/cache/job_key.h"
#include "pipeline/cache/packed_numbers.h"
#include "pipeline/cache/result_cache.h"
#include "pipeline/solve/checks.h"
#include "pipeline/solve/distinct_directions.h"
#include "pipeline/solve/optics_memo.h"
#include "pipeline/solve/parallel.h"
#include "pipeline/solve/phase_errors.h"
#include "pipeline/solve/polarisation.h"
#include "pipeline/solve/rules.h"
#include "pipeline/solve/scene_optics.h"
#include "pipeline/solve/surface_part.h"
#include "rte/grid/discretisation.h"
#include "rte/math/tolerance_budget.h"
#include "rte/stack/layered_reflection.h"

namespace miebrdf {
namespace {

bool has_closed_form(const LayerRequest& request, std::size_t w) {
    // With the reciprocal coupling light is weighted where it leaves, and all of it is not 1.
    const bool counts_all = request.quantity == LayerQuantity::albedo ||
                            (request.quantity == LayerQuantity::albedo_through_surface &&
                             request.scene.coupling == rte::SurfaceCoupling::paper);
    return counts_all && absorbs_nothing(request.scene, w) && !request.scene.has_optical_steps();
}

std::string layer_hash(const LayerRequest& request, std::size_t w) {
    const ResolvedScene& scene = request.scene;
    JobKey key("layers");
    key.add(request.quantity).add(request.keeps_errors);
    if (request.quantity == LayerQuantity::albedo_through_surface) add_surface(key, scene, w);
    scene.add_to(key, w);
    key.add(scene.particles.tolerance).add(request.solver).add(request.directions);
    return key.hash();
}

LayerSlice without_work(const char* method) {
    LayerSlice slice;
    slice.report.converged = slice.report.solver.converged = true;
    slice.report.solver.method = method;
    return slice;
}

/// A half-space that absorbs nothing returns everything in every direction.
LayerSlice lossless(std::size_t incidences) {
    LayerSlice slice = without_work("closed form of layers that absorb nothing");
    slice.values.assign(incidences + 1, 1.0);
    slice.transmittance.assign(incidences + 1, 0.0);
    slice.unscattered_transmittance.assign(incidences, 0.0);
    slice.polarised_plane_albedo.assign(incidences, 0.0);
    return slice;
}

/// The slice of layers that scatter nothing: a black ground absorbs all light, and infinitely deep
/// layers transmit none.
LayerSlice black(const LayerRequest& request) {
    const Directions& d = request.directions;
    LayerSlice slice = without_work("closed form of layers that scatter nothing");
    if (request.quantity == LayerQuantity::reflection) {
        slice.values.assign(d.mu_in.size() * d.mu_out.size() * d.azimuth_deg.size(), 0.0);
        slice.plane_albedo.assign(d.mu_in.size(), 0.0);
    } else {
        const double passed = request.scene.substrate ? 1.0 : 0.0;
        slice.values.assign(d.mu_in.size() + 1, 0.0);
        slice.transmittance.assign(d.mu_in.size() + 1, passed);
        slice.unscattered_transmittance.assign(d.mu_in.size(), passed);
        slice.polarised_plane_albedo.assign(d.mu_in.size(), 0.0);
    }
    return slice;
}

/// Plane and spherical albedos, of the light that the surface lets in and out if that is asked.
rte::AlbedoTable solve_albedo(const rte::Stack& stack, const LayerRequest& request,
                              const SolverOptions& solver, std::size_t w, const Control& control,
                              rte::SolutionMemory& memory) {
    const std::vector<double>& mu_in = request.directions.mu_in;
    if (request.quantity == LayerQuantity::albedo)
        return rte::albedo(stack, mu_in, solver, {}, &memory);
    const ResolvedScene& scene = request.scene;
    Control remembering = control;  // an integral at each node
    remembering.cache = {};         // but many of them
    std::optional<rte::SurfaceTransmission> transmission;
    const auto weights = [&](double mu) -> rte::SurfaceWeights {
        JobKey key("surface at a cosine");
        add_surface(key, scene, w);
        const std::vector<double> known = remembered_numbers(remembering, key.add(mu).hash(), [&] {
            if (!transmission)
                transmission.emplace(rte::SurfaceLobe(scene.surface_index[w], *scene.surface),
                                     scene.coupling);
            const auto [in, out] = transmission->weights(mu);
            return std::vector<double>{in, out};
        });
        return {known[0], known[1]};
    };
    return rte::albedo(stack, mu_in, solver, weights, &memory);
}

/// An albedo above 1 or below 0 by the rounding of its sum over nodes becomes 1 or 0.
void remove_rounding(std::vector<double>& albedos) {
    constexpr double kRounding = 64 * std::numeric_limits<double>::epsilon();
    for (double& albedo : albedos) {
        if (albedo > 1.0 && albedo <= 1.0 + kRounding) albedo = 1.0;
        if (albedo < 0.0 && albedo >= -kRounding) albedo = 0.0;
    }
}

/// A slice with a value of NaN or infinity has an infinite error.
void refuse_lost_values(LayerSlice& slice) {
    const auto is_finite = [](double value) { return std::isfinite(value); };
    if (std::all_of(slice.values.begin(), slice.values.end(), is_finite)) return;
    slice.report.error_estimate = std::numeric_limits<double>::infinity();
    slice.report.converged = false;
}

/// Elements 11 of matrices.
std::vector<double> intensities(const rte::ReflectionTable& table,
                                const std::vector<double>& values) {
    const auto elements = std::size_t(table.components * table.components);
    std::vector<double> all;
    for (std::size_t k = 0; k < values.size(); k += elements) all.push_back(values[k]);
    return all;
}

/// Fills in the reflection.
/// @return the error of transfer and of points of P together
double solve_reflection(const LayerRequest& request, const SceneOptics& optics, std::size_t w,
                        const OpticsDemand& demand, int components, const SolverOptions& solver,
                        const mie::Executor& run, rte::SolutionMemory& memory, LayerSlice& slice) {
    const rte::Stack& stack = optics.stack;
    const bool intensity_only = request.quantity == LayerQuantity::reflection;
    rte::ReflectionTable table =
        components > 1 ? rte::reflect_polarised(stack, request.directions,
                                                {components, intensity_only}, solver, &memory)
                       : rte::reflect(stack, request.directions, solver, &memory);
    slice.values = std::move(table.reflection);
    slice.plane_albedo = std::move(table.plane_albedo);
    slice.polarised_plane_albedo = std::move(table.polarised_plane_albedo);
    slice.mirror_reflectance = std::move(table.mirror_reflectance);
    slice.report.solver = table.report;
    remove_rounding(slice.plane_albedo);
    // Matrices have one estimate for all elements and directions.
    if (table.errors.empty())
        table.errors.assign(slice.values.size() / std::size_t(table.components * table.components),
                            table.report.error_estimate);
    const SolvedLayers solved{stack, request.directions, table.report.moments, solver.delta_m,
                              table.errors};
    if (components > 1) {
        PhaseErrors errors = phase_errors(solved, intensities(table, slice.values));
        slice.report.phase_noise = errors.noise;
        if (request.keeps_errors) slice.errors = std::move(errors.of_values);
        return errors.with_transfer;
    }
    const double tolerance = request.solver.tolerance;
    PhaseErrors left = refine_phase(
        request.scene, w, demand, solved,
        rest_for_phase(tolerance, optics.mie_error_estimate, table.errors), slice.values, run);
    slice.report.phase_noise = left.noise;
    if (request.keeps_errors) slice.errors = std::move(left.of_values);
    // Transfer was given less than the tolerance; points of P have left some of the difference.
    slice.report.solver.converged =
        has_converged(table.report.error_estimate, tolerance, table.steps_converged);
    return left.with_transfer;
}

double solve_albedos(const LayerRequest& request, const SceneOptics& optics, std::size_t w,
                     int components, const SolverOptions& solver, const Control& control,
                     rte::SolutionMemory& memory, LayerSlice& slice) {
    rte::AlbedoTable table =
        components > 1
            ? rte::polarised_albedo(optics.stack, request.directions.mu_in, solver, &memory)
            : solve_albedo(optics.stack, request, solver, w, control, memory);
    slice.values = std::move(table.plane_albedo);
    slice.values.push_back(table.spherical_albedo);
    remove_rounding(slice.values);
    slice.polarised_plane_albedo = std::move(table.polarised_plane_albedo);
    slice.transmittance = std::move(table.transmittance);
    // Nothing comes through a half-space.
    slice.transmittance.resize(slice.values.size(), 0.0);
    remove_rounding(slice.transmittance);
    slice.unscattered_transmittance = std::move(table.unscattered_transmittance);
    slice.mirror_reflectance = std::move(table.mirror_reflectance);
    slice.report.solver = table.report;
    return table.report.error_estimate;
}

LayerSlice solve(const LayerRequest& request, const SceneOptics& optics, std::size_t w,
                 const OpticsDemand& demand, const LightChoice& light, const Control& control,
                 rte::SolutionMemory& memory) {
    const rte::Stack& stack = optics.stack;
    const bool returns_nothing =
        stack.base_kind == rte::BaseKind::none && stack.coats.empty() && !stack.boundary;
    if (returns_nothing && request.quantity != LayerQuantity::mueller) return black(request);
    const double tolerance = request.solver.tolerance;
    // Points of the table are computed anew for unpolarised light alone.
    const bool has_noise = request.quantity == LayerQuantity::reflection && light.components == 1 &&
                           has_noisy_phase(stack);
    SolverOptions solver = request.solver;
    solver.tolerance = tolerance_for_transfer(
        tolerance, optics.mie_error_estimate + (has_noise ? kPhaseShare * tolerance : 0.0));
    LayerSlice slice;
    slice.report.optical_depths = optics.optical_depths;
    const double with_transfer =
        is_reflection(request.quantity)
            ? solve_reflection(request, optics, w, demand, light.components, solver,
                               pieces_of_job(control), memory, slice)
            : solve_albedos(request, optics, w, light.components, solver, control, memory, slice);
    judge(slice.report, with_transfer, optics.mie_error_estimate, tolerance);
    for (double& error : slice.errors) error += optics.mie_error_estimate;
    state_light(light, slice.report);
    refuse_lost_values(slice);
    return slice;
}

/// Noise of scattering matrices is not reduced by points of P that are computed anew. Where it
/// exceeds its share, matrices are averaged once more, with the tolerance of sizes times
/// kFinerMatrices.
constexpr double kFinerMatrices = 0.125;

bool wants_finer_sizes(const WavelengthReport& report, double tolerance) {
    return report.stokes > 1 && !(report.error_estimate <= tolerance) &&
           2.0 * report.phase_noise.largest > kPhaseShare * tolerance;
}

}  // namespace

/// What the cache stores of a slice.
template <Is<LayerSlice> T>
auto fields(T& value) {
    auto& [values, plane_albedo, transmittance, unscattered, mirror_reflectance, polarised, errors,
           report] = value;
    return std::tie(values, plane_albedo, transmittance, unscattered, mirror_reflectance, polarised,
                    errors, report);
}

namespace {

/// The jobs of a request and their solutions, which several passes fill in.
class LayerPasses {
  public:
    LayerPasses(const LayerRequest& request, const std::vector<LayerJob>& jobs,
                const Control& control)
        : request_(request),
          jobs_(jobs),
          control_(control),
          solved_(jobs.size()),
          light_(jobs.size()) {}

    /// Fills in closed forms and what the cache knows; chooses the light of the other jobs.
    /// @return the other jobs
    std::vector<std::size_t> look_up() {
        std::vector<std::size_t> missing;
        for (std::size_t j = 0; j < jobs_.size(); ++j) {
            std::optional<std::vector<double>> known;
            if (jobs_[j].closed_form) {
                solved_[j] = lossless(request_.directions.mu_in.size());
            } else if (control_.cache != nullptr && (known = control_.cache->find(jobs_[j].hash))) {
                NumberUnpacker(*known).read(solved_[j]);
            } else {
                missing.push_back(j);
            }
        }
        const auto chosen = light_of(request_, wavelengths_of(missing), control_);
        for (std::size_t i = 0; i < missing.size(); ++i) light_[missing[i]] = chosen[i];
        return missing;
    }

    /// Solves jobs with the optics of `demand` and stores them in the cache.
    /// @param whole  the optics that any number of nodes could use
    /// @return the jobs that want moments beyond `demand` (lacks_moments); they are not stored
    std::vector<std::size_t> solve_with(const OpticsDemand& demand, const OpticsDemand& whole,
                                        const std::vector<std::size_t>& jobs) {
        std::vector<char> polarised;
        polarised.reserve(jobs.size());
        for (const std::size_t j : jobs) polarised.push_back(light_[j].components > 1);
        const auto optics =
            visible_optics(request_.scene, request_.directions, tolerance_of_hiding(request_),
                           wavelengths_of(jobs), polarised, demand, control_);
        std::vector<char> wants_more(jobs.size(), 0);
        run_parallel("radiative transfer", jobs.size(), control_, [&](std::size_t i) {
            const LayerJob& job = jobs_[jobs[i]];
            LayerSlice& slice = solved_[jobs[i]];
            slice = solve(request_, optics[i], job.wavelength, demand, light_[jobs[i]], control_,
                          memories_.local());
            wants_more[i] = demand.highest_moment < whole.highest_moment &&
                            lacks_moments(demand, slice.report, optics[i].stack);
            if (control_.cache != nullptr && !wants_more[i])
                control_.cache->store(job.hash, NumberPacker().add(slice).take());
        });
        std::vector<std::size_t> left;
        for (std::size_t i = 0; i < jobs.size(); ++i) {
            if (wants_more[i]) left.push_back(jobs[i]);
        }
        return left;
    }

    std::vector<LayerSlice>& solved() { return solved_; }  ///< by job

  private:
    std::vector<std::size_t> wavelengths_of(const std::vector<std::size_t>& jobs) const {
        std::vector<std::size_t> wavelengths;
        wavelengths.reserve(jobs.size());
        for (const std::size_t j : jobs) wavelengths.push_back(jobs_[j].wavelength);
        return wavelengths;
    }

    const LayerRequest& request_;
    const std::vector<LayerJob>& jobs_;
    const Control& control_;
    std::vector<LayerSlice> solved_;
    std::vector<LightChoice> light_;  ///< by job
    tbb::enumerable_thread_specific<rte::SolutionMemory> memories_{
        [this] { return memory_of(control_); }};
};

}  // namespace

LayerSlice spread(LayerSlice slice, const DistinctDirections& distinct, LayerQuantity quantity) {
    if (quantity == LayerQuantity::mueller || distinct.are_all()) return slice;
    if (quantity == LayerQuantity::reflection) {
        slice.values = distinct.spread(slice.values);
        if (!slice.errors.empty()) slice.errors = distinct.spread(slice.errors);
    } else {
        for (auto* list : {&slice.values, &slice.transmittance}) {
            const double of_uniform_light = list->back();
            *list = distinct.spread_incident(*list);
            list->push_back(of_uniform_light);
        }
    }
    for (auto* list : {&slice.plane_albedo, &slice.unscattered_transmittance,
                       &slice.mirror_reflectance, &slice.polarised_plane_albedo}) {
        if (!list->empty()) *list = distinct.spread_incident(*list);
    }
    return slice;
}

int moments_of_nodes(int streams) { return rte::moments_per_node(streams) * streams; }

bool lacks_moments(const OpticsDemand& demand, const WavelengthReport& solved,
                   const rte::Stack& stack) {
    const auto is_cut = [](const rte::Optics& optics) { return optics.has_more_moments; };
    const bool is_base_cut = stack.base_kind == rte::BaseKind::half_space && is_cut(stack.base);
    return solved.stokes == 1 && moments_of_nodes(solved.solver.streams) > demand.highest_moment &&
           solved.solver.moments >= demand.highest_moment &&
           (is_base_cut || std::any_of(stack.coats.begin(), stack.coats.end(),
                                       [&](const rte::Coat& coat) { return is_cut(coat.optics); }));
}

LayerQuantity albedo_quantity(const ResolvedScene& scene) {
    return scene.surface ? LayerQuantity::albedo_through_surface : LayerQuantity::albedo;
}

bool is_reflection(LayerQuantity quantity) {
    return quantity == LayerQuantity::reflection || quantity == LayerQuantity::mueller;
}

PhaseDemand phase_demand(LayerQuantity quantity) {
    return is_reflection(quantity) ? PhaseDemand::whole : PhaseDemand::moments_only;
}

double tolerance_of_hiding(const LayerRequest& request) {
    const bool transmits = request.scene.substrate && request.quantity == LayerQuantity::albedo;
    return transmits ? 0.0 : request.solver.tolerance;
}

int streams_of_first_pass(const LayerRequest& request) {
    return rte::first_streams(kLeastTransferShare * request.solver.tolerance);
}

OpticsDemand first_demand(const LayerRequest& request, const OpticsDemand& whole) {
    OpticsDemand demand = whole;
    const int streams = streams_of_first_pass(request);
    if (request.solver.streams == 0 && !whole.whole_phase_function) {
        demand.highest_moment = std::min(whole.highest_moment, moments_of_nodes(streams));
    }
    return demand;
}

LayerJobs list_layer_jobs(const LayerRequest& request) {
    LayerJobs list;
    std::map<std::string, std::size_t> known;
    for (std::size_t w = 0; w < request.scene.wavelength_nm.size(); ++w) {
        std::string hash = layer_hash(request, w);
        const auto [found, is_new] = known.try_emplace(hash, list.jobs.size());
        list.serving.push_back(found->second);
        if (is_new) list.jobs.push_back({w, std::move(hash), has_closed_form(request, w)});
    }
    return list;
}

std::vector<LayerSlice> without_values(const ResolvedScene& scene) {
    std::vector<LayerSlice> slices(scene.wavelength_nm.size());
    for (std::size_t w = 0; w < slices.size(); ++w) {
        slices[w].report.wavelength_nm = scene.wavelength_nm[w];
        slices[w].report.converged = slices[w].report.solver.converged = true;
    }
    return slices;
}

std::vector<LayerSlice> compute_layers(const LayerRequest& request, const Control& control) {
    if (is_reflection(request.quantity) && has_no_pairs(request.directions))
        return without_values(request.scene);
    const DistinctDirections distinct(request.directions);
    LayerRequest reduced = request;
    // U and V tell azimuths of different sign apart.
    if (request.quantity != LayerQuantity::mueller) reduced.directions = distinct.directions();
    const LayerJobs list = list_layer_jobs(reduced);
    LayerPasses passes(reduced, list.jobs, control);
    const std::vector<std::size_t> missing = passes.look_up();
    // First with the moments that the first nodes use. Where more nodes were needed, then with the
    // moments that these use.
    const OpticsDemand whole = demand_of(request.solver, request.scene.particles.tolerance,
                                         phase_demand(request.quantity));
    std::vector<LayerSlice>& solved = passes.solved();
    OpticsDemand demand = first_demand(request, whole);
    for (std::vector<std::size_t> left = missing;;) {
        left = passes.solve_with(demand, whole, left);
        if (left.empty()) break;
        for (const std::size_t j : left)
            demand.highest_moment =
                std::max(demand.highest_moment, moments_of_nodes(solved[j].report.solver.streams));
        demand.highest_moment = std::min(demand.highest_moment, whole.highest_moment);
    }
    std::vector<std::size_t> noisy;
    for (const std::size_t j : missing) {
        if (wants_finer_sizes(solved[j].report, request.solver.tolerance)) noisy.push_back(j);
    }
    if (!noisy.empty() && request.scene.particles.tolerance == 0.0) {
        OpticsDemand finer = whole;
        finer.tolerance *= kFinerMatrices;
        passes.solve_with(finer, whole, noisy);
    }
    std::vector<LayerSlice> slices;
    std::vector<int> uses(list.jobs.size(), 0);
    for (const std::size_t job : list.serving) ++uses[job];
    for (std::size_t w = 0; w < list.serving.size(); ++w) {
        const std::size_t job = list.serving[w];
        const bool is_last = --uses[job] == 0;
        slices.push_back(
            spread(is_last ? std::move(solved[job]) : solved[job], distinct, request.quantity));
        slices.back().report.wavelength_nm = request.scene.wavelength_nm[w];
    }
    return slices;
}

}  // namespace miebrdf
