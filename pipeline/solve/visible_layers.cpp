#include "pipeline/solve/visible_layers.h"

#include <algorithm>
#include <cmath>

#include "pipeline/plan/rules.h"
#include "pipeline/solve/parallel.h"
#include "pipeline/solve/tolerance.h"

namespace miebrdf {
namespace {

constexpr double kShare = kToleranceShares.hidden_layers;
constexpr double kSafety = 10.0;  // bases that are not Lambertian
// Enough for transmissions to some per cent, which is all that a yes or no needs.
constexpr int kStreams = 16;

double largest(const std::vector<double>& cosines) {
    return cosines.empty() ? 1.0 : *std::max_element(cosines.begin(), cosines.end());
}

rte::AlbedoTable albedo_over_ground(const rte::Optics& coat, double optical_depth,
                                    const std::vector<double>& cosines, double ground_albedo) {
    rte::Stack stack;
    stack.base_kind = rte::BaseKind::lambertian;
    stack.ground_albedo = ground_albedo;
    stack.coats = {{coat, optical_depth}};
    rte::SolverOptions options;
    options.streams = kStreams;
    return rte::albedo(stack, cosines, options);
}

/// Coats from the top down that may hide what is below; the first that does so decides.
std::vector<std::size_t> candidates(const Scene& scene, const Request& request) {
    std::vector<std::size_t> list;
    for (std::size_t c = scene.coats.size(); c-- > 0;) {
        if (may_hide(scene.coats[c].optical_depth, request.directions, request.solver.tolerance)) {
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

bool may_hide(double optical_depth, const rte::Directions& directions, double tolerance) {
    const double way = 1.0 / largest(directions.mu_in) + 1.0 / largest(directions.mu_out);
    return std::exp(-optical_depth * way) <= kShare * tolerance;
}

bool hides_what_is_below(const rte::Optics& coat, double optical_depth,
                         const rte::Directions& directions, double tolerance) {
    if (!may_hide(optical_depth, directions, tolerance)) return false;
    if (std::isinf(optical_depth)) return true;
    std::vector<double> cosines = directions.mu_in;
    cosines.insert(cosines.end(), directions.mu_out.begin(), directions.mu_out.end());
    const rte::AlbedoTable black = albedo_over_ground(coat, optical_depth, cosines, 0.0);
    const rte::AlbedoTable white = albedo_over_ground(coat, optical_depth, cosines, 1.0);
    const auto visible = [&](std::size_t i) {
        return std::abs(white.plane_albedo[i] - black.plane_albedo[i]);
    };
    const double mean = std::abs(white.spherical_albedo - black.spherical_albedo);
    // Differences below this are rounding of the solver: nothing is left to see.
    constexpr double rounding = 1e-13;
    const std::size_t incident = directions.mu_in.size();
    const bool albedo_only = directions.mu_out.empty();
    if (albedo_only && !(kSafety * mean <= kShare * tolerance * black.spherical_albedo))
        return false;
    for (std::size_t i = 0; i < incident; ++i) {
        const double allowed = kShare * tolerance * black.plane_albedo[i];
        if (albedo_only && !(kSafety * visible(i) <= allowed)) return false;
        for (std::size_t o = incident; o < cosines.size(); ++o) {
            const double change = visible(i) * visible(o) / std::max(mean, rounding);
            if (!(kSafety * change <= allowed)) return false;
        }
    }
    return true;
}

rte::Stack with_black_ground(rte::Stack stack) {
    if (stack.base_kind != rte::BaseKind::half_space) return stack;
    if (stack.base.single_scattering_albedo != 0.0) return stack;
    stack.base_kind = rte::BaseKind::none;
    while (!stack.coats.empty() && stack.coats.front().optics.single_scattering_albedo == 0.0) {
        stack.coats.erase(stack.coats.begin());
    }
    return stack;
}

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
        hidden[w] = hides_what_is_below(stacks[w].stack.base, optical_depth, request.directions,
                                        request.solver.tolerance);
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
