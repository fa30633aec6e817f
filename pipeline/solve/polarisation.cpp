#include "pipeline/solve/polarisation.h"

#include <fmt/format.h>
#include <miebrdf/error.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "pipeline/scene/medium_kinds.h"

namespace miebrdf {
namespace {

/// Changes of R11 over albedo times the mean of b1^2: 0.2 to 1.1 in the cases of
/// docs/polarisation.md, each at the direction where it is largest.
constexpr double kChangePerPolarisation = 1.5;
/// No case changes by more than 0.11.
constexpr double kLargestChange = 0.15;

/// Spheres beyond this size parameter change little: the mean of b1^2 is below 0.02 for relative
/// indices up to 2.7.
constexpr double kCoarse = 3.0;
constexpr double kCoarseChange = 0.03;

/// A boundary of index 1.5 polarises what passes by 0.23 at the cosine 0.2 in air and by 0.10 at
/// 0.5, on the way in and out. It changes light scattered once in proportion to b1: an estimate.
constexpr double kBoundaryPerB1 = 0.5;
/// Two surfaces without scattering in between, a third of the light reflected by the lower one: an
/// estimate for cosines from 0.2.
constexpr double kTwoSurfacesChange = 0.05;
/// Means of b1^2 over the sphere of coarse spheres and of molecules.
constexpr double kCoarseSquare = 0.02, kFineSquare = 0.3;

/// `auto` asks for no scattering matrices of spheres beyond this: they would cost more than the
/// rest.
constexpr double kMostAutomaticSize = 60.0;

double size_parameter(const ResolvedSpecies& species, std::size_t w) {
    const Particles& at = species.particles[w];
    return 2e3 * std::numbers::pi * at.host_index * species.effective_radius_um / at.wavelength_nm;
}

bool polarises(const ResolvedSpecies& species, std::size_t w) {
    if (species.needs_mie()) return true;
    const rte::Optics optics =
        kind_of(species.species).optics(species.species, species.wavelength_nm[w]);
    return optics.polarisation && optics.single_scattering_albedo > 0.0;
}

/// Size parameters of the species that polarise; molecules: 0. Infinite and 0: none does.
struct SizeSpan {
    double finest = std::numeric_limits<double>::infinity();
    double coarsest = 0.0;
};

SizeSpan polarising_sizes(const ResolvedScene& scene, std::size_t w) {
    SizeSpan span;
    for (std::size_t m = scene.first_medium(); m < scene.media.size(); ++m) {
        for (const ResolvedSpecies& species : scene.media[m].species) {
            if (!polarises(species, w)) continue;
            const double x = species.needs_mie() ? size_parameter(species, w) : 0.0;
            span.finest = std::min(span.finest, x);
            span.coarsest = std::max(span.coarsest, x);
        }
    }
    return span;
}

bool has_named_method(const SolverOptions& solver) {
    return solver.grid != rte::GridKind::automatic ||
           solver.half_space_method != rte::HalfSpaceMethod::automatic ||
           solver.coat_method != rte::CoatMethod::automatic;
}

/// Light may meet two of Fresnel's surfaces without being scattered in between: what one polarises
/// shows at the other, whatever the layers do.
bool has_two_surfaces(const ResolvedScene& scene) {
    return scene.boundary && (scene.substrate == Substrate::Kind::mirror ||
                              scene.substrate == Substrate::Kind::none ||
                              scene.media.size() > scene.first_medium() + 1);
}

/// What a boundary does to the polarisation, beside what the layers do: it decides nothing.
double change_by_boundary(const ResolvedScene& scene, double mean_square) {
    if (!scene.boundary) return 0.0;
    return kBoundaryPerB1 * std::sqrt(mean_square) +
           (has_two_surfaces(scene) ? kTwoSurfacesChange : 0.0);
}

double mean_square_b1(const rte::Optics& optics) {
    if (!optics.polarisation) return 0.0;
    double sum = 0.0;
    const std::vector<double>& b1 = optics.polarisation->b1;
    for (std::size_t l = 2; l < b1.size(); ++l) sum += b1[l] * b1[l] / (2.0 * double(l) + 1.0);
    return optics.single_scattering_albedo * sum;
}

}  // namespace

std::string why_no_polarisation(const ResolvedScene& scene, const SolverOptions& solver) {
    if (scene.surface)
        return "a rough surface (roughness) lets through and reflects unpolarised light";
    if (scene.boundary && scene.boundary->is_rough())
        return "a rough boundary is computed for unpolarised light alone; smooth ones polarise by "
               "Fresnel's equations";
    if (has_named_method(solver))
        return "grid, half-space-method and coat-method must be auto: other methods are for "
               "unpolarised light alone";
    for (std::size_t m = scene.first_medium(); m < scene.media.size(); ++m) {
        for (const ResolvedSpecies& species : scene.media[m].species) {
            if (species.crowded)
                return "crowded particles (packing) are computed for unpolarised light alone";
        }
    }
    return {};
}

LightChoice choose_light(const LayerRequest& request, std::size_t w) {
    const int asked = request.solver.stokes;
    if (asked == 1) return {.reason = "one component was asked for"};
    const std::string why = why_no_polarisation(request.scene, request.solver);
    if (asked > 1) {
        if (!why.empty()) throw UsageError("stokes", asked, "1 or auto for this scene: " + why);
        return {.components = asked, .reason = "asked for"};
    }
    const auto [finest, coarsest] = polarising_sizes(request.scene, w);
    // Layers that scatter unpolarised light forget what one surface did to it.
    if (std::isinf(finest) && !has_two_surfaces(request.scene))
        return {.reason = "no layer polarises the light that it scatters"};
    if (std::isinf(finest)) {
        return {.left_out = kTwoSurfacesChange,
                .reason = fmt::format("no layer polarises the light that it scatters; boundary and "
                                      "lower surface together change values by less than {:.1g} "
                                      "(stokes 3 has it computed)",
                                      kTwoSurfacesChange)};
    }
    const double bound =
        change_by_polarisation(finest) +
        change_by_boundary(request.scene, finest >= kCoarse ? kCoarseSquare : kFineSquare);
    if (!why.empty()) return {.left_out = bound, .reason = why};
    if (change_by_polarisation(finest) <= request.solver.tolerance || finest >= kCoarse) {
        return {.left_out = bound,
                .reason = fmt::format("size parameters of {:.3g} and above: values change by less "
                                      "than {:.1g} (stokes 3 has it computed)",
                                      finest, bound)};
    }
    if (coarsest > kMostAutomaticSize) {
        return {.left_out = bound,
                .reason = fmt::format("size parameter {:.3g}: scattering matrices would cost more "
                                      "than the rest (stokes 3 has them computed)",
                                      coarsest)};
    }
    return {.left_out = bound, .needs_matrices = true};
}

LightChoice choose_light(const LayerRequest& request, const rte::Stack& stack) {
    const double change = change_by_polarisation(stack);
    const double tolerance = request.solver.tolerance;
    if (change <= tolerance) {
        const double left_out =
            change + change_by_boundary(request.scene, change / kChangePerPolarisation);
        return {.left_out = left_out,
                .reason = fmt::format("single scattering polarises so little that values change by "
                                      "less than {:.1g}",
                                      left_out)};
    }
    return {.components = 3,
            .reason = fmt::format("without it values would change by up to {:.1g}", change)};
}

std::vector<LightChoice> choose_light(const LayerRequest& request,
                                      const std::vector<std::size_t>& wavelengths, double hiding,
                                      OpticsDemand demand, const Control& control) {
    demand.polarisation = true;
    std::vector<LightChoice> light;
    std::vector<std::size_t> unknown, unknown_wavelengths;
    for (const std::size_t w : wavelengths) {
        light.push_back(choose_light(request, w));
        if (!light.back().needs_matrices) continue;
        unknown.push_back(light.size() - 1);
        unknown_wavelengths.push_back(w);
    }
    if (unknown.empty()) return light;
    const auto optics = visible_optics(request.scene, request.directions, hiding,
                                       unknown_wavelengths, demand, control);
    for (std::size_t i = 0; i < unknown.size(); ++i)
        light[unknown[i]] = choose_light(request, optics[i].stack);
    return light;
}

std::vector<SceneOptics> optics_in(const std::vector<LightChoice>& light,
                                   const LayerRequest& request,
                                   const std::vector<std::size_t>& wavelengths, double hiding,
                                   OpticsDemand demand, const Control& control) {
    std::vector<SceneOptics> all(wavelengths.size());
    for (const bool polarised : {false, true}) {
        std::vector<std::size_t> places, some;
        for (std::size_t i = 0; i < wavelengths.size(); ++i) {
            if ((light[i].components > 1) != polarised) continue;
            places.push_back(i);
            some.push_back(wavelengths[i]);
        }
        if (places.empty()) continue;
        demand.polarisation = polarised;
        auto optics =
            visible_optics(request.scene, request.directions, hiding, some, demand, control);
        for (std::size_t i = 0; i < places.size(); ++i) all[places[i]] = std::move(optics[i]);
    }
    return all;
}

double change_by_polarisation(const rte::Stack& stack) {
    double largest =
        stack.base_kind == rte::BaseKind::half_space ? mean_square_b1(stack.base) : 0.0;
    for (const rte::Coat& coat : stack.coats) {
        if (coat.optical_depth > 0.0) largest = std::max(largest, mean_square_b1(coat.optics));
    }
    return std::min(kLargestChange, kChangePerPolarisation * largest);
}

double change_by_polarisation(double effective_size_parameter) {
    return effective_size_parameter >= kCoarse ? kCoarseChange : kLargestChange;
}

}  // namespace miebrdf
