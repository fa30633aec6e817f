#include "pipeline/solve/scene_optics.h"

#include <algorithm>
#include <functional>
#include <numeric>
#include <utility>

#include "pipeline/solve/parallel.h"
#include "pipeline/solve/polarisation.h"
#include "rte/grid/refraction_grid.h"
#include "rte/stack/hidden_layers.h"

namespace miebrdf {
namespace {

struct Place {
    std::size_t wavelength;  ///< index in the scene
    std::size_t place;       ///< index in the list of wavelengths wanted
};

void put_on_ground(const ResolvedScene& scene, std::size_t wavelength, rte::Stack& stack) {
    stack.ground_albedo = scene.ground_albedo[wavelength];
    stack.base_kind = stack.ground_albedo > 0.0 ? rte::BaseKind::lambertian : rte::BaseKind::none;
    if (scene.ground) {
        stack.base_kind = rte::BaseKind::brdf;
        stack.ground = *scene.ground;
    }
    if (!scene.scene_host_index.empty()) stack.base_index = scene.scene_host_index[wavelength];
    const bool is_free = scene.substrate == Substrate::Kind::none && scene.boundary;
    if (!is_free && scene.mirror_index.empty()) return;
    stack.base_kind = rte::BaseKind::mirror;
    stack.mirror_index = is_free ? 1.0 : scene.mirror_index[wavelength];
}

/// The refractive index of a medium's host; 1 in a scene without boundaries.
double index_of(const ResolvedScene& scene, std::size_t medium, std::size_t wavelength) {
    return scene.has_optical_steps() ? scene.media[medium].host_index[wavelength] : 1.0;
}

/// The stack of media first ... last - 1: the first is the half-space, unless a substrate lies
/// below.
rte::Stack stack_of(const ResolvedScene& scene, std::size_t first, std::size_t last, std::size_t w,
                    const std::function<rte::Coat(std::size_t medium)>& layer) {
    rte::Stack stack;
    stack.boundary = scene.boundary;
    const bool on_ground = first == 0 && scene.substrate;
    if (on_ground) put_on_ground(scene, w, stack);
    for (std::size_t m = on_ground ? 1 : first; m < last; ++m) {
        rte::Coat coat = layer(m);
        coat.index = index_of(scene, m, w);
        if (m == first) {
            stack.base = std::move(coat.optics);
            stack.base_index = coat.index;
        } else {
            stack.coats.push_back(std::move(coat));
        }
    }
    return stack;
}

/// Computes optics from the topmost layers down, as far as they are visible.
class StackBuilder {
  public:
    StackBuilder(const ResolvedScene& scene, const Directions& directions, double tolerance,
                 const std::vector<std::size_t>& wavelengths, const OpticsDemand& demand,
                 const Control& control)
        : scene_(scene),
          directions_(directions),
          tolerance_(tolerance),
          demand_(demand),
          control_(control),
          depths_(optical_depths_of(scene, wavelengths, demand.tolerance, control)) {}

    /// The optics of the visible ones of media 0 ... last - 1.
    std::vector<SceneOptics> visible_below(std::size_t last,
                                           const std::vector<Place>& places) const {
        if (places.empty()) return {};
        const std::size_t layer = highest_candidate(last, places);
        if (layer == 0) return stacks_of(0, last, places);

        std::vector<SceneOptics> stacks = stacks_of(layer, last, places);
        std::vector<char> hidden(stacks.size());
        run_parallel("hidden layers", stacks.size(), control_, [&](std::size_t i) {
            hidden[i] =
                rte::hides_what_is_below(stacks[i].stack.base, depth(layer, places[i]),
                                         below_boundary(scene_, places[i].wavelength, directions_),
                                         hiding_tolerance(scene_, tolerance_));
        });
        std::vector<std::size_t> seen;
        std::vector<Place> seen_places;
        for (std::size_t i = 0; i < stacks.size(); ++i) {
            if (hidden[i]) continue;
            seen.push_back(i);
            seen_places.push_back(places[i]);
        }
        const auto lower = visible_below(layer, seen_places);
        for (std::size_t i = 0; i < seen.size(); ++i) {
            stacks[seen[i]] = joined(lower[i], stacks[seen[i]], depth(layer, seen_places[i]));
        }
        return stacks;
    }

    const std::vector<double>& depths(std::size_t place) const { return depths_[place]; }

    /// The optics of media first ... last - 1 (stack_of).
    std::vector<SceneOptics> stacks_of(std::size_t first, std::size_t last,
                                       const std::vector<Place>& places) const {
        const bool on_ground = first == 0 && scene_.substrate;
        std::vector<std::size_t> media(last - first - (on_ground ? 1 : 0)), wavelengths;
        std::iota(media.begin(), media.end(), on_ground ? 1 : first);
        for (const Place at : places) wavelengths.push_back(at.wavelength);
        const auto optics = optics_of(scene_, media, wavelengths, demand_, control_);
        std::vector<SceneOptics> scenes;
        for (std::size_t p = 0; p < places.size(); ++p) {
            SceneOptics& whole = scenes.emplace_back();
            whole.lowest_medium = first;
            whole.stack = stack_of(scene_, first, last, places[p].wavelength,
                                   [&](std::size_t m) -> rte::Coat {
                                       const bool is_base = m == first;
                                       return {optics[p][m - media.front()].optics,
                                               is_base ? 0.0 : depth(m, places[p])};
                                   });
            for (const MediumOptics& of : optics[p]) {
                whole.mie_error_estimate = std::max(whole.mie_error_estimate, of.error_estimate);
                whole.converged = whole.converged && of.converged;
            }
        }
        return scenes;
    }

  private:
    double depth(std::size_t medium, Place at) const { return depths_[at.place][medium - 1]; }

    /// Puts `upper` on `lower`; the base of `upper` becomes a layer of this optical depth.
    static SceneOptics joined(const SceneOptics& lower, const SceneOptics& upper,
                              double optical_depth) {
        SceneOptics whole = lower;
        whole.stack.coats.push_back({upper.stack.base, optical_depth, upper.stack.base_index});
        whole.stack.coats.insert(whole.stack.coats.end(), upper.stack.coats.begin(),
                                 upper.stack.coats.end());
        whole.mie_error_estimate = std::max(lower.mie_error_estimate, upper.mie_error_estimate);
        whole.converged = lower.converged && upper.converged;
        return whole;
    }

    /// The topmost of media 1 ... last - 1 that at some wavelength may hide the media below; 0:
    /// none.
    std::size_t highest_candidate(std::size_t last, const std::vector<Place>& places) const {
        for (std::size_t medium = last; medium-- > 1;) {
            for (const Place at : places) {
                if (rte::may_hide(depth(medium, at),
                                  below_boundary(scene_, at.wavelength, directions_),
                                  hiding_tolerance(scene_, tolerance_)))
                    return medium;
            }
        }
        return 0;
    }

    const ResolvedScene& scene_;
    const Directions& directions_;
    double tolerance_;
    const OpticsDemand& demand_;
    const Control& control_;
    std::vector<std::vector<double>> depths_;  ///< [place][layer]
};

std::vector<Place> places_of(const std::vector<std::size_t>& wavelengths) {
    std::vector<Place> places;
    for (std::size_t p = 0; p < wavelengths.size(); ++p) places.push_back({wavelengths[p], p});
    return places;
}

}  // namespace

std::vector<SceneOptics> visible_optics(const ResolvedScene& scene, const Directions& directions,
                                        double tolerance,
                                        const std::vector<std::size_t>& wavelengths,
                                        const OpticsDemand& demand, const Control& control) {
    const StackBuilder builder(scene, directions, tolerance, wavelengths, demand, control);
    std::vector<SceneOptics> stacks =
        builder.visible_below(scene.media.size(), places_of(wavelengths));
    for (std::size_t p = 0; p < stacks.size(); ++p) {
        stacks[p].stack = rte::with_black_ground(std::move(stacks[p].stack));
        stacks[p].optical_depths = builder.depths(p);
    }
    return stacks;
}

std::vector<SceneOptics> visible_optics(const ResolvedScene& scene, const Directions& directions,
                                        double tolerance,
                                        const std::vector<std::size_t>& wavelengths,
                                        const std::vector<char>& polarised, OpticsDemand demand,
                                        const Control& control) {
    std::vector<SceneOptics> all(wavelengths.size());
    for (const bool with : {false, true}) {
        std::vector<std::size_t> places, some;
        for (std::size_t i = 0; i < wavelengths.size(); ++i) {
            if (bool(polarised[i]) != with) continue;
            places.push_back(i);
            some.push_back(wavelengths[i]);
        }
        if (places.empty()) continue;
        demand.polarisation = with;
        auto optics = visible_optics(scene, directions, tolerance, some, demand, control);
        for (std::size_t i = 0; i < places.size(); ++i) all[places[i]] = std::move(optics[i]);
    }
    return all;
}

std::vector<SceneOptics> optics_from(const ResolvedScene& scene, std::size_t lowest_medium,
                                     const std::vector<std::size_t>& wavelengths,
                                     const OpticsDemand& demand, const Control& control) {
    const StackBuilder builder(scene, {}, 0.0, wavelengths, demand, control);
    return builder.stacks_of(lowest_medium, scene.media.size(), places_of(wavelengths));
}

void require_computable(const ResolvedScene& scene, const SolverOptions& solver, std::size_t w) {
    require_light(scene, solver);
    OpticsDemand demand = demand_of(solver, scene.particles.tolerance, PhaseDemand::moments_only);
    const auto require = [&](const ResolvedMedium& medium, std::size_t at) {
        for (const ResolvedSpecies& species : medium.species)
            require_computable(species, at, demand);
    };
    for (const ResolvedDepth& depth : scene.depths) {
        if (depth.reference) require(*depth.reference, 0);
    }
    demand.polarisation = solver.stokes > 1;
    for (const ResolvedMedium& medium : scene.present_media()) require(medium, w);
    rte::validate(stack_of(scene, 0, scene.media.size(), w, [](std::size_t) -> rte::Coat {
        return {rte::isotropic_optics(1.0), 1.0};
    }));
}

Directions below_boundary(const ResolvedScene& scene, std::size_t wavelength,
                          const Directions& directions) {
    return rte::refracted(directions, scene.top_index(wavelength));
}

double hiding_tolerance(const ResolvedScene& scene, double tolerance) {
    return scene.boundary ? 0.01 * tolerance : tolerance;
}

}  // namespace miebrdf
