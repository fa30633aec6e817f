#include "pipeline/layers.h"

#include <algorithm>
#include <map>
#include <optional>

#include "pipeline/distinct_directions.h"
#include "pipeline/packed_layers.h"
#include "pipeline/parallel.h"
#include "pipeline/result_cache.h"
#include "pipeline/rules.h"
#include "pipeline/visible_layers.h"
#include "rte/layered_brdf.h"

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
                              LayerQuantity quantity, double wavelength_nm) {
    const std::vector<double>& mu_in = request.directions.mu_in;
    if (quantity == LayerQuantity::albedo) return rte::albedo(stack, mu_in, solver);
    const rte::SurfaceLobe lobe(media.surface_index_at(wavelength_nm), *request.scene.surface);
    const rte::SurfaceTransmission transmission(lobe, request.scene.coupling);
    return rte::albedo(stack, mu_in, solver,
                       [&transmission](double mu) { return transmission.weights(mu); });
}

/// What Mie theory leaves of the tolerance, so that both estimates together stay within it. A
/// --mie-tolerance that leaves nothing was the user's choice: half is for the streams all the same.
rte::SolverOptions with_rest_of_tolerance(rte::SolverOptions solver, double mie_error_estimate) {
    solver.tolerance = std::max(solver.tolerance - mie_error_estimate, 0.5 * solver.tolerance);
    return solver;
}

LayerSlice solve(const Request& request, const SceneMedia& media, const SceneOptics& optics,
                 LayerQuantity quantity, double wavelength_nm) {
    const rte::SolverOptions solver =
        with_rest_of_tolerance(request.solver, optics.mie_error_estimate);
    const rte::Stack stack = with_black_ground(optics.stack);
    if (stack.base_kind == rte::BaseKind::none && stack.coats.empty()) {
        return black(request, quantity);
    }
    LayerSlice slice;
    if (quantity == LayerQuantity::reflection) {
        rte::ReflectionTable table = rte::reflect(stack, request.directions, solver);
        slice.values = std::move(table.reflection);
        slice.report = table.report;
        slice.plane_albedo = std::move(table.plane_albedo);
    } else {
        rte::AlbedoTable table =
            solve_albedo(stack, request, solver, media, quantity, wavelength_nm);
        slice.values = std::move(table.plane_albedo);
        slice.values.push_back(table.spherical_albedo);
        slice.report = table.report;
    }
    slice.mie_error_estimate = optics.mie_error_estimate;
    slice.error_estimate = slice.report.error_estimate + optics.mie_error_estimate;
    slice.converged = slice.report.converged && optics.converged;
    return slice;
}

/// Jobs that differ, and which of them serves each wavelength.
struct LayerJobs {
    std::vector<std::string> hashes;
    std::vector<double> wavelength_nm;
    std::vector<std::size_t> serving;  ///< [wavelength]
};

LayerJobs list_jobs(const Request& request, const SceneMedia& media, LayerQuantity quantity) {
    LayerJobs jobs;
    std::map<std::string, std::size_t> known;
    for (const double wavelength_nm : request.wavelength_nm) {
        const std::string hash = layer_hash(request, media, quantity, wavelength_nm);
        const auto [found, is_new] = known.try_emplace(hash, jobs.hashes.size());
        jobs.serving.push_back(found->second);
        if (!is_new) continue;
        jobs.hashes.push_back(hash);
        jobs.wavelength_nm.push_back(wavelength_nm);
    }
    return jobs;
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
    const LayerJobs jobs = list_jobs(reduced, media, quantity);
    std::vector<LayerSlice> solved(jobs.hashes.size());
    std::vector<std::size_t> missing;
    std::vector<double> missing_nm;
    for (std::size_t j = 0; j < solved.size(); ++j) {
        std::optional<std::vector<double>> known;
        if (has_closed_form(media, quantity, jobs.wavelength_nm[j])) {
            solved[j] = lossless(reduced.directions.mu_in.size());
        } else if (control.cache != nullptr && (known = control.cache->find(jobs.hashes[j]))) {
            solved[j] = unpacked_layers(*known);
        } else {
            missing.push_back(j);
            missing_nm.push_back(jobs.wavelength_nm[j]);
        }
    }
    const PhaseDemand phase =
        quantity == LayerQuantity::reflection ? PhaseDemand::whole : PhaseDemand::moments_only;
    const auto optics =
        visible_optics(media, reduced, missing_nm, demand_of(reduced, phase), control);
    run_parallel("radiative transfer", missing.size(), control, [&](std::size_t i) {
        const std::size_t j = missing[i];
        solved[j] = solve(reduced, media, optics[i], quantity, missing_nm[i]);
        if (control.cache != nullptr) control.cache->store(jobs.hashes[j], packed(solved[j]));
    });
    std::vector<LayerSlice> slices;
    for (const std::size_t j : jobs.serving)
        slices.push_back(spread(solved[j], distinct, quantity));
    return slices;
}

}  // namespace miebrdf
