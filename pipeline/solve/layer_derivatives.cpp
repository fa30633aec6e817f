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
/// that no average over sizes chooses its sizes anew, and all changes share those of a species.
class ChangedSpheres {
  public:
    ChangedSpheres(const ResolvedScene& middle, std::vector<const SceneChange*> changes,
                   std::size_t w, const OpticsDemand& demand, const Control& control)
        : changes_(std::move(changes)), control_(control) {
        for (std::size_t c = 0; c < changes_.size(); ++c) {
            Control own = control;
            own.cache = nullptr;
            plus_.push_back(own);
            minus_.push_back(own);
            plus_.back().memo = make_optics_memo();
            minus_.back().memo = make_optics_memo();
        }
        OpticsDemand of_depth;
        of_depth.tolerance = demand.tolerance;
        for (std::size_t m = middle.first_medium(); m < middle.media.size(); ++m) {
            const auto medium = [m](const ResolvedScene& scene) -> auto& { return scene.media[m]; };
            add(middle, medium, w, demand);
            if (m == 0 || middle.depths[m - 1].is_grey()) continue;
            add(middle, medium, w, of_depth);
            const auto reference = [m](const ResolvedScene& scene) -> auto& {
                return *scene.depths[m - 1].reference;
            };
            if (middle.depths[m - 1].reference) add(middle, reference, 0, of_depth);
        }
    }

    const Control& plus(std::size_t change) const { return plus_[change]; }
    const Control& minus(std::size_t change) const { return minus_[change]; }

  private:
    template <typename MediumOf>
    void add(const ResolvedScene& middle, const MediumOf& medium_of, std::size_t w,
             const OpticsDemand& of_all) {
        for (std::size_t s = 0; s < medium_of(middle).species.size(); ++s) {
            const ResolvedSpecies& species = medium_of(middle).species[s];
            if (!species.needs_mie()) continue;
            std::vector<SpeciesChange> changes;
            for (const SceneChange* const change : changes_) {
                changes.push_back(
                    {&medium_of(change->plus).species[s], &medium_of(change->minus).species[s]});
            }
            const OpticsDemand demand = crowd_demand(species, of_all);
            if (!has_smooth_phase(species.species)) {
                keep(species, changes, w, demand);
                continue;
            }
            // Smooth phase functions are made anew whenever they are asked for.
            std::vector<std::pair<ResolvedSpecies, ResolvedSpecies>> averaged;
            averaged.reserve(changes.size());
            for (SpeciesChange& change : changes) {
                averaged.emplace_back(averaged_particles(*change.plus, w),
                                      averaged_particles(*change.minus, w));
                change = {&averaged.back().first, &averaged.back().second};
            }
            keep(averaged_particles(species, w), changes, 0,
                 demand_of_average(species.species, demand));
        }
    }

    /// @param changes  one for each of changes_
    void keep(const ResolvedSpecies& species, const std::vector<SpeciesChange>& changes,
              std::size_t w, const OpticsDemand& demand) {
        const mie::Executor pieces = pieces_of_job(control_);
        const auto hash = [&](const ResolvedSpecies& one) { return optics_hash(one, w, demand); };
        const MediumOptics known = species_optics(control_, species, w, demand, pieces);
        std::vector<std::size_t> places;
        std::vector<SpeciesChange> different;
        for (std::size_t c = 0; c < changes.size(); ++c) {
            const auto& [plus, minus] = changes[c];
            if (plus->key[w] == species.key[w] && minus->key[w] == species.key[w]) {
                plus_[c].memo->keep(hash(species), known);
                minus_[c].memo->keep(hash(species), known);
                continue;
            }
            places.push_back(c);
            different.push_back(changes[c]);
        }
        if (different.empty()) return;
        const bool has_lattice =
            lattice_of(control_, species, demand) != nullptr &&
            std::all_of(different.begin(), different.end(), [&](const SpeciesChange& change) {
                return is_resized(species, change, w);
            });
        if (has_lattice) {
            for (std::size_t i = 0; i < places.size(); ++i) {
                const auto& [plus, minus] = different[i];
                plus_[places[i]].memo->keep(hash(*plus),
                                            species_optics(control_, *plus, w, demand, pieces));
                minus_[places[i]].memo->keep(hash(*minus),
                                             species_optics(control_, *minus, w, demand, pieces));
            }
            return;
        }
        const auto changed = remembered_changes(known, species, different, w, demand, pieces);
        for (std::size_t i = 0; i < places.size(); ++i) {
            plus_[places[i]].memo->keep(hash(*different[i].plus), changed[i].first);
            minus_[places[i]].memo->keep(hash(*different[i].minus), changed[i].second);
        }
    }

    /// changed_optics, from an earlier scene where the memo keeps them.
    std::vector<std::pair<MediumOptics, MediumOptics>> remembered_changes(
        const MediumOptics& known, const ResolvedSpecies& middle,
        const std::vector<SpeciesChange>& changes, std::size_t w, const OpticsDemand& demand,
        const mie::Executor& pieces) const {
        OpticsMemo& memo = *control_.memo;
        if (!memo.keeps_changes) return changed_optics(known, middle, changes, w, demand, pieces);
        JobKey all("changed spheres");
        all.add(optics_hash(middle, w, demand));
        for (const auto& [plus, minus] : changes)
            all.add(optics_hash(*plus, w, demand)).add(optics_hash(*minus, w, demand));
        const std::string key = all.hash();
        const auto name = [&](std::size_t change, const char* side) {
            return fmt::format("{} {} {}", key, change, side);
        };
        std::vector<std::pair<MediumOptics, MediumOptics>> found;
        for (std::size_t i = 0; i < changes.size(); ++i) {
            const auto plus = memo.find(name(i, "+")), minus = memo.find(name(i, "-"));
            if (!plus || !minus) break;
            found.emplace_back(*plus, *minus);
        }
        if (found.size() == changes.size()) return found;
        auto computed = changed_optics(known, middle, changes, w, demand, pieces);
        // Each holds the phase function in the middle and its slope.
        const std::size_t bytes = 2 * bytes_of(known);
        for (std::size_t i = 0; i < changes.size(); ++i) {
            memo.keep(name(i, "+"), computed[i].first, bytes);
            memo.keep(name(i, "-"), computed[i].second, bytes);
        }
        return computed;
    }

    /// The same spheres of other sizes: polynomials of a lattice are smooth in these.
    static bool is_resized(const ResolvedSpecies& middle, const SpeciesChange& change,
                           std::size_t w) {
        const auto material = [&](const ResolvedSpecies& one) {
            return JobKey("material").add(one.particles[w]).hash();
        };
        return material(*change.plus) == material(middle) &&
               material(*change.minus) == material(middle);
    }

    std::vector<const SceneChange*> changes_;
    const Control& control_;
    std::vector<Control> plus_, minus_;
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
        if (demand_.highest_moment >= whole.highest_moment ||
            !lacks_moments(demand_, solved, optics_.stack))
            return;
        demand_.highest_moment =
            std::min(whole.highest_moment, moments_of_nodes(solved.solver.streams));
        find_optics();
    }

    /// One slice for each change.
    std::vector<LayerSlice> of(const std::vector<SceneChange>& changes) const {
        const std::string key = layers_key(request_, request_.scene, w_);
        std::vector<std::size_t> places;
        std::vector<const SceneChange*> different;
        for (std::size_t c = 0; c < changes.size(); ++c) {
            const SceneChange& change = changes[c];
            if (layers_key(request_, change.plus, w_) == key &&
                layers_key(request_, change.minus, w_) == key)
                continue;
            different.push_back(&change);
            places.push_back(c);
        }
        const ChangedSpheres spheres(request_.scene, different, w_, demand_, control_);
        std::vector<rte::StackChange> stacks;
        stacks.reserve(different.size());
        for (std::size_t i = 0; i < different.size(); ++i) {
            const SceneChange& change = *different[i];
            stacks.push_back({stack_of(change.plus, spheres.plus(i)),
                              stack_of(change.minus, spheres.minus(i)), change.apart[w_],
                              changed_weights(request_, change.plus, w_),
                              changed_weights(request_, change.minus, w_)});
            require_bound(change, stacks.back());
        }
        std::vector<LayerSlice> slices(changes.size());
        std::vector<LayerSlice> changed =
            is_reflection(request_.quantity) ? reflections(stacks) : albedos(stacks);
        for (std::size_t k = 0; k < places.size(); ++k) slices[places[k]] = std::move(changed[k]);
        return slices;
    }

  private:
    void find_optics() {
        optics_ = visible_optics(request_.scene, request_.directions, tolerance_of_hiding(request_),
                                 {w_}, demand_, control_)
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
            slice.unscattered_transmittance = std::move(table.unscattered_transmittance);
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
