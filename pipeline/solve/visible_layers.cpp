#include "pipeline/solve/visible_layers.h"

#include <algorithm>

#include "pipeline/plan/rules.h"
#include "pipeline/solve/parallel.h"
#include "rte/stack/hidden_layers.h"

namespace miebrdf {
namespace {

/// Coats from the top down that may hide what is below; the first that does so decides.
std::vector<std::size_t> candidates(const Scene& scene, const Request& request) {
    std::vector<std::size_t> list;
    for (std::size_t c = scene.coats.size(); c-- > 0;) {
        if (rte::may_hide(scene.coats[c].optical_depth, request.directions,
                          request.solver.tolerance)) {
            list.push_back(c);
        }
    }
    return list;
}

/// Puts `upper`, whose base is coat number `c` of the whole scene, on `lower`.
SceneOptics joined(const SceneOptics& lower, const SceneOptics& upper, double optical_depth) {
    SceneOptics whole = lower;
    whole.stack.coats.push_back({upper.stack.base, optical_depth});
    whole.stack.coats.insert(whole.stack.coats.end(), upper.stack.coats.begin(),
                             upper.stack.coats.end());
    whole.mie_error_estimate = std::max(lower.mie_error_estimate, upper.mie_error_estimate);
    whole.converged = lower.converged && upper.converged;
    return whole;
}

}  // namespace

std::vector<SceneOptics> visible_optics(const SceneMedia& media, const Request& request,
                                        const std::vector<double>& wavelength_nm,
                                        const OpticsDemand& demand, const RunControl& control) {
    if (wavelength_nm.empty()) return {};
    const std::vector<std::size_t> coats = candidates(media.scene(), request);
    if (coats.empty()) return media.optics(wavelength_nm, demand, control);

    const std::size_t coat = coats.front();
    const double optical_depth = media.scene().coats[coat].optical_depth;
    std::vector<SceneOptics> stacks = media.from_coat(coat).optics(wavelength_nm, demand, control);
    std::vector<char> hidden(stacks.size());
    run_parallel("hidden layers", stacks.size(), control, [&](std::size_t w) {
        hidden[w] = rte::hides_what_is_below(stacks[w].stack.base, optical_depth,
                                             request.directions, request.solver.tolerance);
    });
    std::vector<std::size_t> seen;
    std::vector<double> seen_nm;
    for (std::size_t w = 0; w < stacks.size(); ++w) {
        if (hidden[w]) continue;
        seen.push_back(w);
        seen_nm.push_back(wavelength_nm[w]);
    }
    const auto lower = visible_optics(media.below_coat(coat), request, seen_nm, demand, control);
    for (std::size_t i = 0; i < seen.size(); ++i) {
        stacks[seen[i]] = joined(lower[i], stacks[seen[i]], optical_depth);
    }
    return stacks;
}

}  // namespace miebrdf
