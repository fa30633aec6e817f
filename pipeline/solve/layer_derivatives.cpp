#include "pipeline/solve/layer_derivatives.h"

#include <fmt/format.h>
#include <miebrdf/error.h>

#include <algorithm>
#include <functional>
#include <utility>

#include <miebrdf/surface.h>
#include "pipeline/cache/job_key.h"
#include "pipeline/solve/distinct_directions.h"
#include "pipeline/solve/parallel.h"
#include "pipeline/solve/scene_optics.h"
#include "pipeline/solve/surface_part.h"
#include "rte/derivatives/stack_derivatives.h"
#include "rte/grid/discretisation.h"
#include "rte/stack/hidden_layers.h"

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

/// Everything that the layers' part of a result depends on.
std::string layers_key(const LayerRequest& request, const ResolvedScene& scene, std::size_t w) {
    JobKey key("layers");
    scene.add_to(key, w);
    if (request.quantity == LayerQuantity::albedo_through_surface) add_surface(key, scene, w);
    return key.hash();
}

/// Averages over sizes choose their sizes anew for every sphere.
void require_same_spheres(const ResolvedScene& scene, const SceneChange& change, std::size_t w) {
    for (std::size_t m = scene.first_medium(); m < scene.media.size(); ++m) {
        for (std::size_t s = 0; s < scene.media[m].species.size(); ++s) {
            const ResolvedSpecies& species = scene.media[m].species[s];
            if (!species.needs_mie() || species.key[w] == change.plus.media[m].species[s].key[w])
                continue;
            throw UsageError(
                fmt::format("derivative by '{}': it changes the spheres of {}; available: amounts, "
                            "depths, media whose optics are given, grounds, boundaries",
                            change.parameter, describe(species.species)));
        }
    }
}

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
            require_same_spheres(request_.scene, change, w_);
            stacks.push_back({stack_of(change.plus), stack_of(change.minus), change.apart[w_],
                              surface_weights(request_, change.plus, w_),
                              surface_weights(request_, change.minus, w_)});
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
        optics_.stack = stack_of(request_.scene);
    }

    rte::Stack stack_of(const ResolvedScene& scene) const {
        return optics_from(scene, optics_.lowest_medium, {w_}, demand_, control_).front().stack;
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
    run_parallel("derivatives", values.size(), control, [&](std::size_t w) {
        std::vector<LayerSlice> here =
            WavelengthDerivatives(reduced, w, values[w].report, control).of(changes);
        for (std::size_t c = 0; c < changes.size(); ++c) {
            if (here[c].values.empty()) continue;
            slices[c][w] = spread(std::move(here[c]), distinct, request.quantity);
        }
    });
    return slices;
}

}  // namespace miebrdf
