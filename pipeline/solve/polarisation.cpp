#include "pipeline/solve/polarisation.h"

#include <fmt/format.h>
#include <miebrdf/error.h>
#include <miebrdf/transfer.h>
#include <oneapi/tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "pipeline/scene/medium_kinds.h"
#include "pipeline/solve/grain_shape.h"
#include "pipeline/solve/parallel.h"
#include "pipeline/solve/scene_optics.h"
#include "rte/math/tolerance_budget.h"
#include "rte/stack/layered_reflection.h"

namespace miebrdf {
namespace {

/// d is the largest relative change of the requested values when polarisation is left out. It is
/// left out where
///     kMargin d <= allowed.
/// The margin is there because d is estimated with fewer sizes (averaged to kCoarse), nodes,
/// directions and wavelengths than were requested: in 160 random scenes it was wrong by a factor
/// of at most 1.7 (tools/bench/left_out_polarisation.py, class mixed).
constexpr double kMargin = 2.0;
constexpr double kCoarse = 1e-2;
constexpr int kStreamsCompared = 12;
constexpr std::size_t kMostCosines = 8, kMostWavelengths = 7;

/// Longest time, in seconds at one wavelength, for scattering matrices of large spheres. Where they
/// take longer, polarisation is left out although it shows: without it a solution takes 0.01 to
/// 0.1 s.
constexpr double kBearableSeconds = 0.5;

/// Without boundaries d <= kChangePerPolarisation x albedo x (mean of b1^2 over the sphere): the
/// first scattering polarises the light by b1, and the second one turns this into a change of
/// intensity by b1 once more. The factor is 0.2 to 1.1 in the cases of docs/polarisation.md.
constexpr double kChangePerPolarisation = 1.5;

/// Size parameter from which on d may be kPromisedWithoutPolarisation instead of the tolerance.
constexpr double kLargeEnough = 3.0;
/// Changes of fluxes are relative to the flux, or to this part of the incident flux if that is
/// larger.
constexpr double kLeastFlux = 0.1;

bool polarises(const ResolvedSpecies& species, std::size_t w) {
    if (species.needs_mie()) return !has_smooth_phase(species.species);
    const rte::Optics optics = species.given->optics(species.wavelength_nm[w]);
    return optics.polarisation && optics.single_scattering_albedo > 0.0;
}

/// Smallest and largest size parameter of the species that polarise; molecules count as 0. Where no
/// species polarises: infinity and 0.
struct SizeSpan {
    double finest = std::numeric_limits<double>::infinity();
    double coarsest = 0.0;
};

SizeSpan polarising_sizes(const ResolvedScene& scene, std::size_t w) {
    SizeSpan span;
    for (const ResolvedMedium& medium : scene.present_media()) {
        for (const ResolvedSpecies& species : medium.species) {
            if (!polarises(species, w)) continue;
            const double x = species.needs_mie() ? size_parameter(species, w) : 0.0;
            span.finest = std::min(span.finest, x);
            span.coarsest = std::max(span.coarsest, x);
        }
    }
    return span;
}

/// Whether spheres below kLargeEnough, which polarise strongly, have more than half of the
/// projected area in any medium. The area decides because a little soot does not show beside grains
/// of ice.
bool is_of_small_spheres(const ResolvedScene& scene, std::size_t w) {
    for (const ResolvedMedium& medium : scene.present_media()) {
        double small = 0.0, all = 0.0;
        for (const ResolvedSpecies& species : medium.species) {
            if (!polarises(species, w)) continue;
            const bool is_sphere = species.needs_mie();
            const double area =
                is_sphere ? species.volume_fraction / species.effective_radius_um : 1.0;
            all += area;
            if (!is_sphere || size_parameter(species, w) < kLargeEnough) small += area;
        }
        if (small > 0.5 * all) return true;
    }
    return false;
}

double allowed_change(const LayerRequest& request, std::size_t w) {
    const double finest = polarising_sizes(request.scene, w).finest,
                 tolerance = request.solver.tolerance;
    return finest >= kLargeEnough && std::isfinite(finest)
               ? std::max(tolerance, kPromisedWithoutPolarisation)
               : tolerance;
}

/// Whether the scattering matrices of large spheres take too long at a wavelength.
bool takes_long(const LayerRequest& request, std::size_t w) {
    const ResolvedScene& scene = request.scene;
    if (polarising_sizes(scene, w).coarsest <= kLargestOwnMatrix) return false;
    const OpticsDemand demand =
        demand_of(request.solver, scene.particles.tolerance, phase_demand(request.quantity));
    double seconds = 0.0;
    for (const ResolvedMedium& medium : scene.present_media()) {
        for (const ResolvedSpecies& species : medium.species) {
            if (species.needs_mie() && polarises(species, w))
                seconds += matrix_seconds(species, w, demand);
        }
    }
    return seconds > kBearableSeconds;
}

bool has_rough_boundary(const ResolvedScene& scene) {
    return scene.boundary && scene.boundary->is_rough();
}

bool has_named_method(const SolverOptions& solver) {
    return solver.grid != rte::GridKind::automatic ||
           solver.half_space_method != rte::HalfSpaceMethod::automatic ||
           solver.coat_method != rte::CoatMethod::automatic;
}

/// Whether light may meet two Fresnel surfaces without being scattered in between. The first one
/// polarises it, and the second one then reflects another part of it, whatever the layers do.
bool has_two_surfaces(const ResolvedScene& scene) {
    return scene.boundary && (scene.substrate == Substrate::Kind::mirror ||
                              scene.substrate == Substrate::Kind::none ||
                              scene.media.size() > scene.first_medium() + 1);
}

/// At most `most` elements of a list, evenly spaced, with the first and the last one.
template <typename T>
std::vector<T> some_of(const std::vector<T>& list, std::size_t most) {
    if (list.size() <= most) return list;
    std::vector<T> some;
    for (std::size_t k = 0; k < most; ++k) some.push_back(list[k * (list.size() - 1) / (most - 1)]);
    return some;
}

/// The largest |without - with| over the largest |with| of the same incidence, or over `least` if
/// that is larger; the incidences are `blocks` equal blocks. kNotCompared where a value is NaN.
double largest_change(const rte::LightComparison& values, std::size_t blocks, double least) {
    double largest = 0.0;
    const std::size_t size = values.with.size() / std::max<std::size_t>(1, blocks);
    for (std::size_t b = 0; b < blocks; ++b) {
        double change = 0.0, scale = least;
        for (std::size_t k = b * size; k < (b + 1) * size; ++k) {
            const double difference = std::abs(values.without[k] - values.with[k]);
            if (std::isnan(difference)) return kNotCompared;
            change = std::max(change, difference);
            scale = std::max(scale, std::abs(values.with[k]));
        }
        if (change > 0.0) largest = std::max(largest, change / scale);
    }
    return largest;
}

/// Albedo times the mean of b1^2 over the sphere, sum_l b1_l^2 / (2l + 1).
double mean_square_b1(const rte::Optics& optics) {
    if (!optics.polarisation) return 0.0;
    double sum = 0.0;
    const std::vector<double>& b1 = optics.polarisation->b1;
    for (std::size_t l = 2; l < b1.size(); ++l) sum += b1[l] * b1[l] / (2.0 * double(l) + 1.0);
    return optics.single_scattering_albedo * sum;
}

double bound_without_boundaries(const rte::Stack& stack) {
    double largest =
        stack.base_kind == rte::BaseKind::half_space ? mean_square_b1(stack.base) : 0.0;
    for (const rte::Coat& coat : stack.coats) {
        if (coat.optical_depth > 0.0) largest = std::max(largest, mean_square_b1(coat.optics));
    }
    return kChangePerPolarisation * largest;
}

/// d at one wavelength: bound_without_boundaries where that is small enough, else the difference of
/// two solutions, with and without polarisation, at some of the directions and with few nodes.
double change_found(const LayerRequest& request, double allowed, const rte::Stack& stack,
                    rte::SolutionMemory& memory) {
    const double bound = bound_without_boundaries(stack);
    if (!request.scene.has_optical_steps() && kMargin * bound <= allowed) return bound;
    const SolverOptions solver{.tolerance = std::max(request.solver.tolerance, kCoarse),
                               .streams = kStreamsCompared,
                               .delta_m = request.solver.delta_m};
    const Directions& all = request.directions;
    const Directions some{some_of(all.mu_in, kMostCosines), some_of(all.mu_out, kMostCosines),
                          some_of(all.azimuth_deg, kMostCosines)};
    if (is_reflection(request.quantity)) {
        return largest_change(rte::compare_light(stack, some, solver, memory), some.mu_in.size(),
                              0.0);
    }
    const rte::LightComparison fluxes = rte::compare_albedos(stack, some.mu_in, solver, memory);
    return largest_change(fluxes, fluxes.with.size(), kLeastFlux);
}

/// d of the light that mirrors, the lower side of a film or steps between hosts send back through a
/// rough boundary, most of it without being scattered. It is computed for a smooth boundary, at the
/// cosines that the facets see: they are tilted by up to about twice the rms slope.
double change_of_mirrored(const rte::Stack& smooth, const Directions& directions,
                          double roughness) {
    constexpr double kLeastMu = 0.05;
    const double tilt = std::atan(2.0 * roughness);
    std::vector<double> cosines;
    for (const std::vector<double>* list : {&directions.mu_in, &directions.mu_out}) {
        for (const double mu : some_of(*list, kMostCosines)) {
            const double angle = std::acos(mu);
            for (const double facet : {std::max(angle - tilt, 0.0), angle, angle + tilt})
                cosines.push_back(std::max(std::cos(facet), kLeastMu));
        }
    }
    rte::ScaledStack memory;
    std::vector<double> numbers, matrices;
    rte::find_mirror_reflectances(smooth, cosines, {}, memory, numbers);
    rte::find_mirror_reflectances(smooth, cosines, {3, true}, memory, matrices);
    return largest_change({numbers, matrices}, cosines.size(), kLeastJudgedFlux);
}

/// d at some wavelengths. Sizes are averaged to kCoarse, and spheres of kLargestOwnMatrix stand in
/// for larger ones, because scattering matrices of these take long. A smooth boundary stands in for
/// a rough one, below which only unpolarised light can be computed.
std::vector<double> changes_found(const LayerRequest& request,
                                  const std::vector<std::size_t>& wavelengths,
                                  const Control& control) {
    OpticsDemand demand = demand_of(request.solver, request.scene.particles.tolerance,
                                    phase_demand(request.quantity));
    demand.polarisation = demand.only_compared = true;
    demand.tolerance = std::max(demand.tolerance, kCoarse);
    const std::vector<SceneOptics> optics =
        visible_optics(request.scene, request.directions, tolerance_of_hiding(request), wavelengths,
                       demand, control);
    std::vector<double> changes(optics.size());
    tbb::enumerable_thread_specific<rte::SolutionMemory> memories;
    run_parallel("polarisation", optics.size(), control, [&](std::size_t i) {
        rte::Stack stack = optics[i].stack;
        if (has_rough_boundary(request.scene)) {
            const double roughness = stack.boundary->roughness;
            stack.boundary = rte::Boundary{};
            changes[i] = change_of_mirrored(stack, request.directions, roughness);
        }
        changes[i] =
            std::max(changes[i], change_found(request, allowed_change(request, wavelengths[i]),
                                              stack, memories.local()));
    });
    return changes;
}

bool has_crowded(const ResolvedScene& scene) {
    const auto media = scene.present_media();
    return std::any_of(media.begin(), media.end(), [](const ResolvedMedium& medium) {
        return std::any_of(medium.species.begin(), medium.species.end(),
                           [](const ResolvedSpecies& species) { return species.crowded; });
    });
}

/// Whether only unpolarised light can be computed, so that d cannot be estimated either.
bool cannot_be_compared(const LayerRequest& request) {
    return request.scene.surface || has_named_method(request.solver) || has_crowded(request.scene);
}

LightChoice chosen_by(const LayerRequest& request, std::size_t w, double change) {
    const double most = kMargin * change;
    if (most <= allowed_change(request, w)) {
        return {.left_out = most,
                .reason = fmt::format("values change by less than {:.1g} without it", most)};
    }
    std::string why = why_no_polarisation(request.scene, request.solver);
    if (why.empty() && takes_long(request, w))
        why = "scattering matrices of large spheres take long (stokes 3 has them computed)";
    const std::string shows = fmt::format("without it values would change by up to {:.1g}", most);
    if (why.empty()) return {.components = 3, .reason = shows};
    return {.left_out = most, .reason = why + "; " + shows, .is_beyond_promise = true};
}

}  // namespace

std::string why_no_polarisation(const ResolvedScene& scene, const SolverOptions& solver) {
    if (scene.surface)
        return "a rough surface (roughness) lets through and reflects unpolarised light";
    if (has_named_method(solver))
        return "grid, half-space-method and coat-method must be auto: other methods are for "
               "unpolarised light alone";
    if (has_crowded(scene))
        return "crowded particles (packing) are computed for unpolarised light alone";
    if (has_rough_boundary(scene))
        return "a rough boundary is computed for unpolarised light alone; smooth ones polarise by "
               "Fresnel's equations";
    return {};
}

void require_light(const ResolvedScene& scene, const SolverOptions& solver) {
    const std::string why = solver.stokes > 1 ? why_no_polarisation(scene, solver) : "";
    if (!why.empty()) throw UsageError("stokes", solver.stokes, "1 or auto for this scene: " + why);
}

void state_light(const LightChoice& light, WavelengthReport& report) {
    report.stokes = light.components;
    report.polarisation_left_out = light.left_out;
    report.converged = report.converged && !light.is_beyond_promise;
}

LightChoice choose_light(const LayerRequest& request, std::size_t w) {
    const int asked = request.solver.stokes;
    if (asked == 1) return {.reason = "one component was asked for"};
    require_light(request.scene, request.solver);
    if (asked > 1) return {.components = asked, .reason = "asked for"};
    const double finest = polarising_sizes(request.scene, w).finest;
    // Layers that scatter unpolarised light forget what one surface did to it.
    if (std::isinf(finest) && !has_two_surfaces(request.scene))
        return {.reason = "no layer polarises the light that it scatters"};
    if (cannot_be_compared(request))
        return {.left_out = kNotCompared,
                .reason = why_no_polarisation(request.scene, request.solver)};
    return {.components = is_of_small_spheres(request.scene, w) ? 3 : 1,
            .reason = "scattering matrices of few sizes tell whether it shows",
            .needs_comparison = true};
}

std::vector<LightChoice> light_of(const LayerRequest& request,
                                  const std::vector<std::size_t>& wavelengths,
                                  const Control& control) {
    std::vector<LightChoice> all;
    all.reserve(wavelengths.size());
    for (const std::size_t w : wavelengths) all.push_back(choose_light(request, w));
    const auto needs = [](const LightChoice& light) { return light.needs_comparison; };
    if (std::none_of(all.begin(), all.end(), needs)) return all;
    // Which ones are looked at depends on the scene alone, not on what of it is known already.
    std::vector<std::size_t> needing;
    for (std::size_t w = 0; w < request.scene.wavelength_nm.size(); ++w) {
        if (needs(choose_light(request, w))) needing.push_back(w);
    }
    // Changes vary slowly with the wavelength: the larger one of both neighbours counts.
    const std::vector<std::size_t> looked_at = some_of(needing, kMostWavelengths);
    const std::vector<double> change = changes_found(request, looked_at, control);
    for (std::size_t i = 0; i < all.size(); ++i) {
        if (!needs(all[i])) continue;
        const std::size_t w = wavelengths[i];
        const auto next = std::lower_bound(looked_at.begin(), looked_at.end(), w);
        const auto k = std::size_t(next - looked_at.begin());
        const bool is_known = *next == w || k == 0;
        all[i] = chosen_by(request, w, is_known ? change[k] : std::max(change[k - 1], change[k]));
    }
    return all;
}

}  // namespace miebrdf
