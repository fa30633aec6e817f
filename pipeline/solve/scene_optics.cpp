#include "pipeline/solve/scene_optics.h"

#include <algorithm>
#include <numeric>

#include "pipeline/solve/parallel.h"
#include "rte/stack/hidden_layers.h"

namespace miebrdf {
namespace {

/// Media first ... last - 1 of a scene, the first as the half-space.
std::vector<SceneOptics> stacks_of(const ResolvedScene& scene, std::size_t first, std::size_t last,
                                   const std::vector<std::size_t>& wavelengths,
                                   const OpticsDemand& demand, const Control& control) {
    std::vector<std::size_t> media(last - first);
    std::iota(media.begin(), media.end(), first);
    std::vector<SceneOptics> scenes;
    for (const auto& optics : optics_of(scene, media, wavelengths, demand, control)) {
        SceneOptics& at_wavelength = scenes.emplace_back();
        for (std::size_t i = 0; i < media.size(); ++i) {
            if (i == 0) {
                at_wavelength.stack.base = optics[i].optics;
            } else {
                at_wavelength.stack.coats.push_back(
                    {optics[i].optics, scene.optical_depth[media[i] - 1]});
            }
            at_wavelength.mie_error_estimate =
                std::max(at_wavelength.mie_error_estimate, optics[i].error_estimate);
            at_wavelength.converged = at_wavelength.converged && optics[i].converged;
        }
    }
    return scenes;
}

/// Puts `upper`, whose base is a layer of that depth, on `lower`.
SceneOptics joined(const SceneOptics& lower, const SceneOptics& upper, double optical_depth) {
    SceneOptics whole = lower;
    whole.stack.coats.push_back({upper.stack.base, optical_depth});
    whole.stack.coats.insert(whole.stack.coats.end(), upper.stack.coats.begin(),
                             upper.stack.coats.end());
    whole.mie_error_estimate = std::max(lower.mie_error_estimate, upper.mie_error_estimate);
    whole.converged = lower.converged && upper.converged;
    return whole;
}

/// The topmost of media 1 ... last - 1 that may hide what is below; 0: none.
std::size_t highest_candidate(const ResolvedScene& scene, std::size_t last,
                              const Directions& directions, double tolerance) {
    for (std::size_t medium = last; medium-- > 1;) {
        if (rte::may_hide(scene.optical_depth[medium - 1], directions, tolerance)) return medium;
    }
    return 0;
}

/// visible_optics of media 0 ... last - 1.
std::vector<SceneOptics> visible_below(const ResolvedScene& scene, std::size_t last,
                                       const Directions& directions, double tolerance,
                                       const std::vector<std::size_t>& wavelengths,
                                       const OpticsDemand& demand, const Control& control) {
    if (wavelengths.empty()) return {};
    const std::size_t layer = highest_candidate(scene, last, directions, tolerance);
    if (layer == 0) return stacks_of(scene, 0, last, wavelengths, demand, control);

    const double optical_depth = scene.optical_depth[layer - 1];
    std::vector<SceneOptics> stacks = stacks_of(scene, layer, last, wavelengths, demand, control);
    std::vector<char> hidden(stacks.size());
    run_parallel("hidden layers", stacks.size(), control, [&](std::size_t i) {
        hidden[i] =
            rte::hides_what_is_below(stacks[i].stack.base, optical_depth, directions, tolerance);
    });
    std::vector<std::size_t> seen, seen_wavelengths;
    for (std::size_t i = 0; i < stacks.size(); ++i) {
        if (hidden[i]) continue;
        seen.push_back(i);
        seen_wavelengths.push_back(wavelengths[i]);
    }
    const auto lower =
        visible_below(scene, layer, directions, tolerance, seen_wavelengths, demand, control);
    for (std::size_t i = 0; i < seen.size(); ++i)
        stacks[seen[i]] = joined(lower[i], stacks[seen[i]], optical_depth);
    return stacks;
}

}  // namespace

std::vector<SceneOptics> visible_optics(const ResolvedScene& scene, const Directions& directions,
                                        double tolerance,
                                        const std::vector<std::size_t>& wavelengths,
                                        const OpticsDemand& demand, const Control& control) {
    std::vector<SceneOptics> stacks = visible_below(scene, scene.media.size(), directions,
                                                    tolerance, wavelengths, demand, control);
    for (SceneOptics& optics : stacks)
        optics.stack = rte::with_black_ground(std::move(optics.stack));
    return stacks;
}

}  // namespace miebrdf
