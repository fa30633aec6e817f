#include "pipeline/solve/layers.h"

#include <oneapi/tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <limits>
#include <optional>

#include <miebrdf/surface.h>
#include "pipeline/cache/result_cache.h"
#include "pipeline/plan/rules.h"
#include "pipeline/solve/distinct_directions.h"
#include "pipeline/solve/layer_jobs.h"
#include "pipeline/solve/packed_layers.h"
#include "pipeline/solve/parallel.h"
#include "pipeline/solve/phase_noise.h"
#include "pipeline/solve/visible_layers.h"
#include "rte/math/tolerance_budget.h"
#include "rte/stack/hidden_layers.h"
#include "rte/stack/stack_solver.h"

namespace miebrdf {

LayerQuantity albedo_quantity(const Scene& scene) {
    return scene.surface ? LayerQuantity::albedo_through_surface : LayerQuantity::albedo;
}

bool has_closed_form(const SceneMedia& media, LayerQuantity quantity, double wavelength_nm) {
    const double k_floor = media.scene().particles.k_floor;
    // The reciprocal coupling weighs where light leaves: all of it may count more or less than 1.
    const bool counts_all = quantity == LayerQuantity::albedo ||
                            (quantity == LayerQuantity::albedo_through_surface &&
                             media.scene().coupling == rte::SurfaceCoupling::paper);
    return counts_all &&
           std::all_of(media.media().begin(), media.media().end(), [&](const ResolvedMedium& m) {
               return absorbs_nothing(m, wavelength_nm, k_floor);
           });
}

namespace {

/// What every direction of a half-space that absorbs nothing returns: everything.
LayerSlice lossless(std::size_t incidences) {
    LayerSlice slice;
    slice.values.assign(incidences + 1, 1.0);
    slice.converged = slice.report.converged = true;
    slice.report.method = "closed form of layers that absorb nothing";
    return slice;
}

/// What layers return of which none scatters.
LayerSlice black(const Request& request, LayerQuantity quantity) {
    const rte::Directions& d = request.directions;
    const bool albedo = quantity != LayerQuantity::reflection;
    LayerSlice slice;
    slice.values.assign(
        albedo ? d.mu_in.size() + 1 : d.mu_in.size() * d.mu_out.size() * d.azimuth_deg.size(), 0.0);
    if (!albedo) slice.plane_albedo.assign(d.mu_in.size(), 0.0);
    slice.converged = slice.report.converged = true;
    slice.report.method = "closed form of layers that scatter nothing";
    return slice;
}

/// Plane and spherical albedos, of the light that the surface lets in and out if that is asked.
rte::AlbedoTable solve_albedo(const rte::Stack& stack, const Request& request,
                              const rte::SolverOptions& solver, const SceneMedia& media,
                              LayerQuantity quantity, double wavelength_nm,
                              rte::StackMemory& memory) {
    const std::vector<double>& mu_in = request.directions.mu_in;
    if (quantity == LayerQuantity::albedo) return rte::albedo(stack, mu_in, solver, {}, &memory);
    const rte::SurfaceLobe lobe(media.surface_index_at(wavelength_nm), *request.scene.surface);
    const rte::SurfaceTransmission transmission(lobe, request.scene.coupling);
    return rte::albedo(
        stack, mu_in, solver, [&transmission](double mu) { return transmission.weights(mu); },
        &memory);
}

/// What Mie theory leaves of the tolerance, so that both estimates together stay within it. A
/// --mie-tolerance that leaves nothing was the user's choice: half is for the streams all the same.
rte::SolverOptions with_rest_of_tolerance(rte::SolverOptions solver, double mie_error_estimate) {
    solver.tolerance = std::max(solver.tolerance - mie_error_estimate, 0.5 * solver.tolerance);
    return solver;
}

/// Layers reflect no more than they get: an albedo above 1 by the rounding of its sum over nodes
/// is 1.
void remove_rounding(std::vector<double>& albedos) {
    constexpr double kRounding = 64 * std::numeric_limits<double>::epsilon();
    for (double& albedo : albedos) {
        if (albedo > 1.0 && albedo <= 1.0 + kRounding) albedo = 1.0;
    }
}

LayerSlice solve(const Request& request, const SceneMedia& media, const SceneOptics& optics,
                 LayerQuantity quantity, double wavelength_nm, rte::StackMemory& memory) {
    const rte::SolverOptions solver =
        with_rest_of_tolerance(request.solver, optics.mie_error_estimate);
    const rte::Stack stack = rte::with_black_ground(optics.stack);
    if (stack.base_kind == rte::BaseKind::none && stack.coats.empty()) {
        return black(request, quantity);
    }
    LayerSlice slice;
    if (quantity == LayerQuantity::reflection) {
        rte::ReflectionTable table = rte::reflect(stack, request.directions, solver, &memory);
        slice.values = std::move(table.reflection);
        slice.report = table.report;
        slice.phase_noise =
            largest_phase_noise(stack, request.directions, slice.values, table.report.moments);
        slice.plane_albedo = std::move(table.plane_albedo);
        remove_rounding(slice.plane_albedo);
    } else {
        rte::AlbedoTable table =
            solve_albedo(stack, request, solver, media, quantity, wavelength_nm, memory);
        slice.values = std::move(table.plane_albedo);
        slice.values.push_back(table.spherical_albedo);
        remove_rounding(slice.values);
        slice.report = table.report;
    }
    slice.mie_error_estimate = optics.mie_error_estimate;
    slice.error_estimate = slice.report.error_estimate + optics.mie_error_estimate;
    slice.converged = has_converged(slice.error_estimate, request.solver.tolerance,
                                    slice.report.converged, optics.converged);
    return slice;
}

/// A slice at the distinct directions as one at all those that were asked for.
LayerSlice spread(const LayerSlice& slice, const DistinctDirections& distinct,
                  LayerQuantity quantity) {
    LayerSlice all = slice;
    if (quantity == LayerQuantity::reflection) {
        all.values = distinct.spread(slice.values);
        all.plane_albedo = distinct.spread_incident(slice.plane_albedo);
    } else {
        all.values = distinct.spread_incident(slice.values);
        all.values.push_back(slice.values.back());  // the spherical albedo
    }
    return all;
}

}  // namespace

std::vector<LayerSlice> compute_layers(const Request& request, const SceneMedia& media,
                                       LayerQuantity quantity, const RunControl& control) {
    const DistinctDirections distinct(request.directions);
    Request reduced = request;
    reduced.directions = distinct.directions();
    const LayerJobs list = list_layer_jobs(reduced, media, quantity);
    const std::vector<LayerJob>& jobs = list.jobs;
    std::vector<LayerSlice> solved(jobs.size());
    std::vector<std::size_t> missing;
    std::vector<double> missing_nm;
    for (std::size_t j = 0; j < solved.size(); ++j) {
        std::optional<std::vector<double>> known;
        if (jobs[j].closed_form) {
            solved[j] = lossless(reduced.directions.mu_in.size());
        } else if (control.cache != nullptr && (known = control.cache->find(jobs[j].hash))) {
            solved[j] = unpacked_layers(*known);
        } else {
            missing.push_back(j);
            missing_nm.push_back(jobs[j].wavelength_nm);
        }
    }
    const auto optics = visible_optics(media, reduced, missing_nm,
                                       demand_of(reduced, phase_demand(quantity)), control);
    tbb::enumerable_thread_specific<rte::StackMemory> memories;
    run_parallel("radiative transfer", missing.size(), control, [&](std::size_t i) {
        const std::size_t j = missing[i];
        solved[j] = solve(reduced, media, optics[i], quantity, missing_nm[i], memories.local());
        if (control.cache != nullptr) control.cache->store(jobs[j].hash, packed(solved[j]));
    });
    std::vector<LayerSlice> slices;
    for (const std::size_t j : list.serving)
        slices.push_back(spread(solved[j], distinct, quantity));
    return slices;
}

}  // namespace miebrdf
