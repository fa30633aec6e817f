#include "pipeline/solve/polarisation.h"

#include <fmt/format.h>
#include <miebrdf/error.h>
#include <miebrdf/transfer.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "pipeline/scene/medium_kinds.h"
#include "pipeline/solve/grain_shape.h"
#include "rte/boundary/fresnel_matrix.h"
#include "rte/math/tolerance_budget.h"

namespace miebrdf {
namespace {

/// Changes of R11 over albedo times the mean of b1^2: 0.2 to 1.1 in the cases of
/// docs/polarisation.md, each at the direction where it is largest.
constexpr double kChangePerPolarisation = 1.5;
/// No case changes by more than 0.11.
constexpr double kLargestChange = 0.15;

/// Spheres beyond this size parameter change less: up to 0.0252 in 120 random half-spaces of size
/// parameters 3 to 60 (tools/bench/left_out_polarisation.py, class bare, seeds 1 and 2), here with
/// kMargin. It stands for what neither is computed nor compared.
constexpr double kCoarse = 3.0;
constexpr double kCoarseChange = 0.04;

/// Changes are looked at with so few nodes, and at some of the directions: differences of two
/// solutions need less than the solutions themselves. With the margin, nothing was left out by
/// mistake in 150 random films and layers of spheres below boundaries, 51 of which changed by more
/// than the promise (docs/polarisation.md).
constexpr int kStreamsOfComparison = 12;
constexpr std::size_t kMostCosinesCompared = 8, kMostAzimuthsCompared = 7;
constexpr double kMargin = 1.5;

/// Changes vary slowly with the wavelength: stand-ins are looked at at the ends and the middle of
/// those that a request has, and those between have the larger change of their neighbours.
constexpr std::size_t kMostWavelengthsCompared = 3;
/// Of the size average of stand-ins.
constexpr double kStandInTolerance = 1e-2;

/// What the scattering matrices of large spheres may take at a wavelength where stand-ins tell that
/// polarisation shows. Solving for numbers takes .01 to .1 s.
constexpr double kBearableSeconds = 0.5;

bool polarises(const ResolvedSpecies& species, std::size_t w) {
    if (species.needs_mie()) return !has_smooth_phase(species.species);
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

bool has_rough_boundary(const ResolvedScene& scene) {
    return scene.boundary && scene.boundary->is_rough();
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

/// (a - b) / (a + b) of the shares that a surface lets through of light polarised in the plane of
/// incidence and across it.
double polarisance(double index, double mu_air) {
    const rte::FresnelMatrix r = rte::fresnel_reflection(1.0, index, mu_air);
    const double along = 1.0 - r.parallel, across = 1.0 - r.across;
    return std::abs(along - across) / (along + across);
}

/// The lowest cosine of diffuse light, towards the horizon.
constexpr double kLowestOfDiffuse = 0.1;

/// A bound on what surfaces change where particles keep polarisation as well as they can: light
/// enters polarised and is looked at through a polariser. A second surface, or a mirror, may do
/// anything.
double change_by_surfaces(const LayerRequest& request, std::size_t w) {
    const ResolvedScene& scene = request.scene;
    if (!scene.has_optical_steps()) return 0.0;
    if (!scene.boundary || has_two_surfaces(scene)) return 1.0;
    const auto strongest = [&](const std::vector<double>& cosines) {
        double mu = kLowestOfDiffuse;
        if (!cosines.empty()) mu = *std::min_element(cosines.begin(), cosines.end());
        return polarisance(scene.top_index(w), mu);
    };
    return (1.0 + strongest(request.directions.mu_in)) *
               (1.0 + strongest(request.directions.mu_out)) -
           1.0;
}

std::vector<double> some_of(const std::vector<double>& list, std::size_t most) {
    if (list.size() <= most) return list;
    std::vector<double> some;
    for (std::size_t k = 0; k < most; ++k) some.push_back(list[k * (list.size() - 1) / (most - 1)]);
    return some;
}

/// Relative to each value, but to no less than `least`. Where one is not a number nothing is known:
/// all of it may change.
double largest_change(const std::vector<double>& without, const std::vector<double>& with,
                      double least = 0.0) {
    double largest = 0.0;
    for (std::size_t k = 0; k < with.size(); ++k) {
        const double change = std::abs(without[k] - with[k]);
        if (std::isnan(change)) return 1.0;
        if (change > 0.0) largest = std::max(largest, change / std::max(std::abs(with[k]), least));
    }
    return largest;
}

/// The change that leaving polarisation out makes to the values asked for, relative to each.
double change_found(const LayerRequest& request, const rte::Stack& stack) {
    SolverOptions solver = request.solver;
    solver.streams = kStreamsOfComparison;
    const Directions& all = request.directions;
    const std::vector<double> mu_in = some_of(all.mu_in, kMostCosinesCompared);
    if (request.quantity == LayerQuantity::reflection ||
        request.quantity == LayerQuantity::mueller) {
        const Directions some{mu_in, some_of(all.mu_out, kMostCosinesCompared),
                              some_of(all.azimuth_deg, kMostAzimuthsCompared)};
        return largest_change(rte::reflect(stack, some, solver).reflection,
                              rte::reflect_polarised(stack, some, {3, true}, solver).reflection);
    }
    const rte::AlbedoTable without = rte::albedo(stack, mu_in, solver);
    const rte::AlbedoTable with = rte::polarised_albedo(stack, mu_in, solver);
    return std::max(
        {largest_change(without.plane_albedo, with.plane_albedo, kLeastJudgedFlux),
         largest_change({without.spherical_albedo}, {with.spherical_albedo}, kLeastJudgedFlux),
         largest_change(without.transmittance, with.transmittance, kLeastJudgedFlux)});
}

double mean_square_b1(const rte::Optics& optics) {
    if (!optics.polarisation) return 0.0;
    double sum = 0.0;
    const std::vector<double>& b1 = optics.polarisation->b1;
    for (std::size_t l = 2; l < b1.size(); ++l) sum += b1[l] * b1[l] / (2.0 * double(l) + 1.0);
    return optics.single_scattering_albedo * sum;
}

}  // namespace

namespace {

/// As why_no_polarisation, but for rough boundaries.
std::string why_not_below_any_boundary(const ResolvedScene& scene, const SolverOptions& solver) {
    if (scene.surface)
        return "a rough surface (roughness) lets through and reflects unpolarised light";
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

}  // namespace

std::string why_no_polarisation(const ResolvedScene& scene, const SolverOptions& solver) {
    std::string why = why_not_below_any_boundary(scene, solver);
    if (why.empty() && has_rough_boundary(scene)) {
        why =
            "a rough boundary is computed for unpolarised light alone; smooth ones polarise by "
            "Fresnel's equations";
    }
    return why;
}

void state_light(const LightChoice& light, WavelengthReport& report) {
    report.stokes = light.components;
    report.polarisation_left_out = light.left_out;
    report.converged = report.converged && !light.is_beyond_promise;
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
    const double bound = (std::isinf(finest) ? 0.0 : change_by_polarisation(finest)) +
                         change_by_surfaces(request, w);
    LightChoice unknown{
        .allowed = finest >= kCoarse && std::isfinite(finest)
                       ? std::max(request.solver.tolerance, kPromisedWithoutPolarisation)
                       : request.solver.tolerance,
        .left_out = bound,
        .reason = why};
    if (!why_not_below_any_boundary(request.scene, request.solver).empty()) return unknown;
    if (coarsest > kLargestOwnMatrix && why.empty()) {
        unknown.reason = fmt::format(
            "size parameter {:.3g}: smaller spheres tell what leaving out "
            "polarisation changes",
            coarsest);
    }
    unknown.needs_stand_ins = !unknown.reason.empty();
    unknown.needs_matrices = !unknown.needs_stand_ins;
    return unknown;
}

LightChoice choose_light(const LayerRequest& request, const LightChoice& unknown,
                         const rte::Stack& stack) {
    const double by_particles = change_by_polarisation(stack);
    double change = by_particles;
    if (request.scene.has_optical_steps() || by_particles > unknown.allowed)
        change = kMargin * change_found(request, stack);
    if (change <= unknown.allowed) {
        return {.left_out = change,
                .reason = fmt::format("values change by less than {:.1g} without it", change)};
    }
    return {.components = 3,
            .reason = fmt::format("without it values would change by up to {:.1g}", change)};
}

namespace {

/// What stand-ins tell: LightChoice::needs_stand_ins.
class StandIns {
  public:
    StandIns(const LayerRequest& request, double hiding, OpticsDemand demand,
             const Control& control)
        : request_(request), hiding_(hiding), demand_(std::move(demand)), control_(control) {}

    /// Of the wavelengths whose light needs them. Which ones are looked at depends on the scene
    /// alone, not on what of it is known already.
    void choose(const std::vector<std::size_t>& wavelengths, std::vector<LitScene>& all) const {
        const auto needs = [](const LitScene& lit) { return lit.light.needs_stand_ins; };
        if (std::none_of(all.begin(), all.end(), needs)) return;
        std::vector<std::size_t> needing;
        for (std::size_t w = 0; w < request_.scene.wavelength_nm.size(); ++w) {
            if (choose_light(request_, w).needs_stand_ins) needing.push_back(w);
        }
        const std::size_t steps = std::min(needing.size(), kMostWavelengthsCompared) - 1;
        std::vector<std::size_t> looked_at;
        for (std::size_t k = 0; k <= steps; ++k)
            looked_at.push_back(needing[steps == 0 ? 0 : k * (needing.size() - 1) / steps]);
        const std::vector<double> changes = changes_at(looked_at);
        for (std::size_t i = 0; i < all.size(); ++i) {
            if (!needs(all[i])) continue;
            const std::size_t w = wavelengths[i];
            const auto next = std::lower_bound(looked_at.begin(), looked_at.end(), w);
            const auto k = std::size_t(next - looked_at.begin());
            const double change =
                *next == w || k == 0 ? changes[k] : std::max(changes[k - 1], changes[k]);
            all[i].light = chosen(all[i].light, w, change);
        }
    }

  private:
    std::vector<double> changes_at(const std::vector<std::size_t>& wavelengths) const {
        OpticsDemand coarse = demand_;
        coarse.polarisation = coarse.stand_ins = true;
        coarse.tolerance = std::max(coarse.tolerance, kStandInTolerance);
        std::vector<double> changes;
        for (SceneOptics& optics : visible_optics(request_.scene, request_.directions, hiding_,
                                                  wavelengths, coarse, control_)) {
            if (optics.stack.boundary) optics.stack.boundary = rte::Boundary{};
            changes.push_back(kMargin * change_found(request_, optics.stack));
        }
        return changes;
    }

    double own_matrices_seconds(std::size_t w) const {
        OpticsDemand own = demand_;
        own.polarisation = true;
        const ResolvedScene& scene = request_.scene;
        double seconds = 0.0;
        for (std::size_t m = scene.first_medium(); m < scene.media.size(); ++m) {
            for (const ResolvedSpecies& species : scene.media[m].species) {
                if (species.needs_mie() && polarises(species, w))
                    seconds += matrix_seconds(species, w, own);
            }
        }
        return seconds;
    }

    LightChoice chosen(const LightChoice& unknown, std::size_t w, double change) const {
        LightChoice light{.left_out = change};
        // What was found, without the margin: as good as an estimate of errors is.
        light.is_beyond_promise =
            change > kMargin * std::max(request_.solver.tolerance, kPromisedWithoutPolarisation);
        if (has_rough_boundary(request_.scene)) {
            light.reason = fmt::format("{}; below a smooth one values would change by up to {:.1g}",
                                       unknown.reason, change);
        } else if (change <= unknown.allowed) {
            light.reason = fmt::format(
                "values change by less than {:.1g} without it, as smaller spheres tell", change);
        } else if (own_matrices_seconds(w) <= kBearableSeconds) {
            return {.components = 3,
                    .reason = fmt::format(
                        "without it values would change by up to {:.1g}, as smaller spheres tell",
                        change)};
        } else {
            light.reason = fmt::format(
                "without it values would change by up to {:.1g}, as smaller spheres tell; "
                "scattering matrices of large ones take long (stokes 3 has them computed)",
                change);
        }
        return light;
    }

    const LayerRequest& request_;
    double hiding_;
    OpticsDemand demand_;
    const Control& control_;
};

}  // namespace

std::vector<LitScene> light_and_optics(const LayerRequest& request,
                                       const std::vector<std::size_t>& wavelengths, double hiding,
                                       OpticsDemand demand, const Control& control) {
    std::vector<LitScene> all(wavelengths.size());
    for (std::size_t i = 0; i < wavelengths.size(); ++i)
        all[i].light = choose_light(request, wavelengths[i]);
    StandIns(request, hiding, demand, control).choose(wavelengths, all);
    for (const bool polarised : {false, true}) {
        std::vector<std::size_t> places, some;
        for (std::size_t i = 0; i < wavelengths.size(); ++i) {
            const LightChoice& light = all[i].light;
            if ((light.components > 1 || light.needs_matrices) != polarised) continue;
            places.push_back(i);
            some.push_back(wavelengths[i]);
        }
        if (places.empty()) continue;
        demand.polarisation = polarised;
        auto optics =
            visible_optics(request.scene, request.directions, hiding, some, demand, control);
        for (std::size_t i = 0; i < places.size(); ++i) {
            LitScene& lit = all[places[i]];
            lit.optics = std::move(optics[i]);
            if (lit.light.needs_matrices)
                lit.light = choose_light(request, lit.light, lit.optics.stack);
        }
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
