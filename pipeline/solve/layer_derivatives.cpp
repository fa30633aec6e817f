#include "pipeline/solve/layer_derivatives.h"

#include <fmt/format.h>
#include <miebrdf/error.h>

#include <algorithm>
#include <functional>
#include <map>
#include <memory>
#include <utility>

#include <miebrdf/surface.h>
#include "pipeline/cache/job_key.h"
#include "pipeline/solve/distinct_directions.h"
#include "pipeline/solve/grain_shape.h"
#include "pipeline/solve/optics_memo.h"
#include "pipeline/solve/parallel.h"
#include "pipeline/solve/scene_optics.h"
#include "pipeline/solve/size_lattice.h"
#include "pipeline/solve/surface_part.h"
#include "rte/derivatives/stack_derivatives.h"
#include "rte/grid/discretisation.h"
#include "rte/stack/scaled_stack.h"

namespace miebrdf {
namespace {

using Weights = std::function<rte::SurfaceWeights(double mu)>;

Weights surface_weights(const LayerRequest& request, const ResolvedScene& scene, std::size_t w) {
    if (request.quantity != LayerQuantity::albedo_through_surface) return {};
    const rte::SurfaceLobe lobe(scene.surface_index[w], *scene.surface);
    const auto transmission =
        std::make_shared<const rte::SurfaceTransmission>(lobe, scene.coupling);
    return [transmission](double mu) { return transmission->weights(mu); };
}

/// The same of a side of a change; empty where it has the surface of the scene.
Weights changed_weights(const LayerRequest& request, const ResolvedScene& side, std::size_t w) {
    if (request.quantity != LayerQuantity::albedo_through_surface) return {};
    JobKey own("surface"), changed("surface");
    add_surface(own, request.scene, w);
    add_surface(changed, side, w);
    return own.hash() == changed.hash() ? Weights{} : surface_weights(request, side, w);
}

/// Everything that the layers' part of a result depends on.
std::string layers_key(const LayerRequest& request, const ResolvedScene& scene, std::size_t w) {
    JobKey key("layers");
    scene.add_to(key, w);
    if (request.quantity == LayerQuantity::albedo_through_surface) add_surface(key, scene, w);
    return key.hash();
}

/// The same of their derivatives.
std::string derivatives_key(const LayerRequest& request, const std::vector<SceneChange>& changes,
                            std::size_t w) {
    JobKey key("derivatives");
    key.add(layers_key(request, request.scene, w));
    for (const SceneChange& change : changes) {
        key.add(layers_key(request, change.plus, w))
            .add(layers_key(request, change.minus, w))
            .add(change.apart[w]);
    }
    return key.hash();
}

/// Optics that scenes with a number a little larger and a little smaller find in their memos, so
/// that no average over sizes chooses its sizes anew.
class ChangedSpheres {
  public:
    ChangedSpheres(const ResolvedScene& middle, const SceneChange& change, std::size_t w,
                   const OpticsDemand& demand, const Control& control)
        : control_(control), plus_(control), minus_(control) {
        for (Control* side : {&plus_, &minus_}) {
            side->cache = nullptr;
            side->memo = make_optics_memo();
        }
        OpticsDemand of_depth;
        of_depth.tolerance = demand.tolerance;
        for (std::size_t m = middle.first_medium(); m < middle.media.size(); ++m) {
            add(middle.media[m], change.plus.media[m], change.minus.media[m], w, demand);
            if (m == 0 || middle.depths[m - 1].is_grey()) continue;
            add(middle.media[m], change.plus.media[m], change.minus.media[m], w, of_depth);
            if (const auto& reference = middle.depths[m - 1].reference) {
                add(*reference, *change.plus.depths[m - 1].reference,
                    *change.minus.depths[m - 1].reference, 0, of_depth);
            }
        }
    }

    const Control& plus() const { return plus_; }
    const Control& minus() const { return minus_; }

  private:
    void add(const ResolvedMedium& middle, const ResolvedMedium& plus, const ResolvedMedium& minus,
             std::size_t w, const OpticsDemand& of_all) {
        for (std::size_t s = 0; s < middle.species.size(); ++s) {
            const ResolvedSpecies& species = middle.species[s];
            const bool is_same = plus.species[s].key[w] == species.key[w] &&
                                 minus.species[s].key[w] == species.key[w];
            // Smooth phase functions are computed whenever they are asked for.
            if (!species.needs_mie() || (is_same && has_smooth_phase(species.species))) continue;
            const OpticsDemand demand = crowd_demand(species, of_all);
            const mie::Executor pieces = pieces_of_job(control_);
            const auto hash = [&](const ResolvedSpecies& one) {
                return optics_hash(one, w, demand);
            };
            const MediumOptics known = species_optics(control_, species, w, demand, pieces);
            const ResolvedSpecies &above = plus.species[s], &below = minus.species[s];
            if (is_same) {
                plus_.memo->keep(hash(species), known);
                minus_.memo->keep(hash(species), known);
                continue;
            }
            auto [larger, smaller] =
                changed_optics(known, species, above, below, w, demand, pieces);
            plus_.memo->keep(hash(above), larger);
            minus_.memo->keep(hash(below), smaller);
        }
    }

    const Control& control_;
    Control plus_, minus_;
};

class WavelengthDerivatives {
  public:
    WavelengthDerivatives(const LayerRequest& request, std::size_t w,
                          const WavelengthReport& solved, const Control& control)
        : request_(request), w_(w), solved_(solved), control_(control) {
        const OpticsDemand whole = demand_of(request.solver, request.scene.particles.tolerance,
                                             phase_demand(request.quantity));
        demand_ = first_demand(request, whole);
        demand_.polarisation = solved.stokes > 1;
        find_optics();
        const bool had_more = solved.solver.streams > first_streams(request) &&
                              solved.stokes == 1 && demand_.highest_moment < whole.highest_moment;
        if (!had_more || !has_cut_moments(optics_.stack)) return;
        demand_ = whole;
        find_optics();
    }

    /// One slice for each change.
    std::vector<LayerSlice> of(const std::vector<SceneChange>& changes) const {
        const std::string key = layers_key(request_, request_.scene, w_);
        std::vector<std::size_t> places;
        std::vector<rte::StackChange> stacks;
        for (std::size_t c = 0; c < changes.size(); ++c) {
            const SceneChange& change = changes[c];
            if (layers_key(request_, change.plus, w_) == key &&
                layers_key(request_, change.minus, w_) == key)
                continue;
            const ChangedSpheres spheres(request_.scene, change, w_, demand_, control_);
            stacks.push_back({stack_of(change.plus, spheres.plus()),
                              stack_of(change.minus, spheres.minus()), change.apart[w_],
                              changed_weights(request_, change.plus, w_),
                              changed_weights(request_, change.minus, w_)});
            require_bound(change, stacks.back());
            places.push_back(c);
        }
        std::vector<LayerSlice> slices(changes.size());
        std::vector<LayerSlice> changed =
            is_reflection(request_.quantity) ? reflections(stacks) : albedos(stacks);
        for (std::size_t k = 0; k < places.size(); ++k) slices[places[k]] = std::move(changed[k]);
        return slices;
    }

  private:
    void find_optics() {
        const bool transmits =
            request_.scene.substrate && request_.quantity == LayerQuantity::albedo;
        optics_ =
            visible_optics(request_.scene, request_.directions,
                           transmits ? 0.0 : request_.solver.tolerance, {w_}, demand_, control_)
                .front();
        optics_.stack = stack_of(request_.scene, control_);
    }

    rte::Stack stack_of(const ResolvedScene& scene, const Control& control) const {
        return optics_from(scene, optics_.lowest_medium, {w_}, demand_, control).front().stack;
    }

    void require_bound(const SceneChange& change, const rte::StackChange& stacks) const {
        if (rte::is_bounded(optics_.stack, stacks)) return;
        throw UsageError(fmt::format(
            "derivative by '{}' at {} nm: the half-space absorbs nothing, and what it reflects "
            "falls like the square root of what it would absorb; start below (an albedo of 0.9999, "
            "k above 0) and fit log(1 - x): log1m",
            change.parameter, request_.scene.wavelength_nm[w_]));
    }

    std::vector<LayerSlice> reflections(const std::vector<rte::StackChange>& stacks) const {
        std::vector<LayerSlice> slices;
        const rte::SolvedLight light(solved_.stokes,
                                     request_.quantity == LayerQuantity::reflection);
        for (rte::ReflectionTable& table :
             rte::reflection_derivatives(optics_.stack, stacks, request_.directions, light,
                                         request_.solver, solved_.solver)) {
            LayerSlice& slice = slices.emplace_back();
            slice.values = std::move(table.reflection);
            slice.mirror_reflectance = std::move(table.mirror_reflectance);
        }
        return slices;
    }

    std::vector<LayerSlice> albedos(const std::vector<rte::StackChange>& stacks) const {
        rte::AlbedoQuestion question{request_.directions.mu_in, solved_.stokes > 1 ? 3 : 1};
        question.transmits = request_.quantity == LayerQuantity::albedo &&
                             rte::lowest_kind(optics_.stack) != rte::BaseKind::half_space &&
                             request_.solver.coat_method == rte::CoatMethod::automatic;
        std::vector<LayerSlice> slices;
        for (rte::AlbedoTable& table : rte::albedo_derivatives(
                 optics_.stack, stacks, question, surface_weights(request_, request_.scene, w_),
                 request_.solver, solved_.solver)) {
            LayerSlice& slice = slices.emplace_back();
            slice.values = std::move(table.plane_albedo);
            slice.values.push_back(table.spherical_albedo);
            slice.transmittance = std::move(table.transmittance);
            slice.transmittance.resize(slice.values.size(), 0.0);
            slice.polarised_plane_albedo = std::move(table.polarised_plane_albedo);
            slice.mirror_reflectance = std::move(table.mirror_reflectance);
        }
        return slices;
    }

    const LayerRequest& request_;
    std::size_t w_;
    const WavelengthReport& solved_;
    const Control& control_;
    OpticsDemand demand_;
    SceneOptics optics_;
};

}  // namespace

std::vector<std::vector<LayerSlice>> layer_derivatives(const LayerRequest& request,
                                                       const std::vector<LayerSlice>& values,
                                                       const std::vector<SceneChange>& changes,
                                                       const Control& control) {
    const DistinctDirections distinct(request.directions);
    LayerRequest reduced = request;
    reduced.directions = distinct.directions();
    std::vector<std::vector<LayerSlice>> slices(changes.size());
    for (auto& of_change : slices) of_change.resize(values.size());
    // Wavelengths of the same optics share their derivatives, as they share their values.
    std::map<std::string, std::vector<std::size_t>> shared;
    for (std::size_t w = 0; w < values.size(); ++w)
        shared[derivatives_key(reduced, changes, w)].push_back(w);
    std::vector<const std::vector<std::size_t>*> jobs;
    jobs.reserve(shared.size());
    for (const auto& [key, wavelengths] : shared) jobs.push_back(&wavelengths);
    run_parallel("derivatives", jobs.size(), control, [&](std::size_t job) {
        const std::vector<std::size_t>& wavelengths = *jobs[job];
        const std::size_t first = wavelengths.front();
        const std::vector<LayerSlice> here =
            WavelengthDerivatives(reduced, first, values[first].report, control).of(changes);
        for (std::size_t c = 0; c < changes.size(); ++c) {
            if (here[c].values.empty()) continue;
            const LayerSlice all = spread(here[c], distinct, request.quantity);
            for (const std::size_t w : wavelengths) slices[c][w] = all;
        }
    });
    return slices;
}

}  // namespace miebrdf
