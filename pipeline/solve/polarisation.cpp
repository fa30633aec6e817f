#include "pipeline/solve/polarisation.h"

#include <fmt/format.h>
#include <miebrdf/error.h>
#include <miebrdf/transfer.h>
#include <oneapi/tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "pipeline/scene/medium_kinds.h"
#include "pipeline/solve/grain_shape.h"
#include "pipeline/solve/parallel.h"
#include "rte/boundary/fresnel_matrix.h"
#include "rte/math/tolerance_budget.h"
#include "rte/stack/layered_reflection.h"
#include "rte/stack/requests.h"

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

/// Fourier orders of a comparison that are left out at the end, and its equations, are judged by
/// this: their share of a change is that of the value.
constexpr double kToleranceOfComparison = 1e-2;

/// Changes vary slowly with the wavelength: stand-ins are looked at at the ends and the middle of
/// those that a request has, and those between have the larger change of their neighbours.
constexpr std::size_t kMostWavelengthsCompared = 3;
/// Of the size averages that are looked at first: of stand-ins, and where matrices take longer than
/// this by the count of their first sizes. Those of a tolerance of 1e-3 take several times as many
/// (TiO2 of 1 um: 13 ms, a coarse one and the comparison 3 ms).
constexpr double kCoarseTolerance = 1e-2;
constexpr double kCheapMatricesSeconds = 2e-4;
/// Changes that coarse averages tell differ from those of fine ones by a factor of 1.72 at most in
/// 160 random scenes (left_out_polarisation.py, class mixed): what is this much less, or more, than
/// what is allowed is decided.
constexpr double kCoarseMargin = 2.0;

/// What the scattering matrices of large spheres may take at a wavelength where stand-ins tell that
/// polarisation shows. Solving for numbers takes .01 to .1 s.
constexpr double kBearableSeconds = 0.5;

bool polarises(const ResolvedSpecies& species, std::size_t w) {
    if (species.needs_mie()) return !has_smooth_phase(species.species);
    const rte::Optics optics = species.given->optics(species.wavelength_nm[w]);
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

/// What the scattering matrices of the scene's spheres take at a wavelength.
double matrices_seconds(const LayerRequest& request, std::size_t w) {
    const ResolvedScene& scene = request.scene;
    const OpticsDemand demand =
        demand_of(request.solver, scene.particles.tolerance, phase_demand(request.quantity));
    double seconds = 0.0;
    for (std::size_t m = scene.first_medium(); m < scene.media.size(); ++m) {
        for (const ResolvedSpecies& species : scene.media[m].species) {
            if (species.needs_mie() && polarises(species, w))
                seconds += matrix_seconds(species, w, demand);
        }
    }
    return seconds;
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
double largest_change(const rte::LightComparison& values, double least) {
    double largest = 0.0;
    for (std::size_t k = 0; k < values.with.size(); ++k) {
        const double change = std::abs(values.without[k] - values.with[k]);
        if (std::isnan(change)) return 1.0;
        if (change > 0.0)
            largest = std::max(largest, change / std::max(std::abs(values.with[k]), least));
    }
    return largest;
}

/// The change that leaving polarisation out makes to the values asked for, relative to each.
double change_found(const LayerRequest& request, const rte::Stack& stack,
                    rte::SolutionMemory& memory) {
    SolverOptions solver = request.solver;
    solver.streams = kStreamsOfComparison;
    solver.tolerance = std::max(solver.tolerance, kToleranceOfComparison);
    const Directions& all = request.directions;
    const std::vector<double> mu_in = some_of(all.mu_in, kMostCosinesCompared);
    if (!is_reflection(request.quantity))
        return largest_change(rte::compare_albedos(stack, mu_in, solver, memory), kLeastJudgedFlux);
    const Directions some{mu_in, some_of(all.mu_out, kMostCosinesCompared),
                          some_of(all.azimuth_deg, kMostAzimuthsCompared)};
    return largest_change(rte::compare_light(stack, some, solver, memory), 0.0);
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
    const std::string why = why_no_polarisation(request.scene, request.solver);
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
    unknown.begins_coarsely =
        unknown.needs_matrices && matrices_seconds(request, w) > kCheapMatricesSeconds;
    return unknown;
}

namespace {

/// What leaving polarisation out changes at most, as far as what is allowed needs to know: a bound
/// by the particles alone, or twice solved with few nodes.
double change_without(const LayerRequest& request, double allowed, const rte::Stack& stack,
                      rte::SolutionMemory& memory) {
    const double by_particles = change_by_polarisation(stack);
    const bool is_enough = !request.scene.has_optical_steps() && by_particles <= allowed;
    return is_enough ? by_particles : kMargin * change_found(request, stack, memory);
}

/// The same of light that mirrors, the bottom of a film or steps between hosts send back through a
/// boundary, most of it without being scattered. Facets of a rough one are tilted by up to about
/// twice the rms slope, by which the cosines at a smooth one differ.
double change_of_mirrored(const rte::Stack& smooth, const Directions& directions,
                          double roughness) {
    constexpr double kLeastMu = 0.05;
    const double tilt = std::atan(2.0 * roughness);
    std::vector<double> cosines;
    for (const std::vector<double>* list : {&directions.mu_in, &directions.mu_out}) {
        for (const double mu : some_of(*list, kMostCosinesCompared)) {
            const double angle = std::acos(mu);
            for (const double facet : {std::max(angle - tilt, 0.0), angle, angle + tilt})
                cosines.push_back(std::max(std::cos(facet), kLeastMu));
        }
    }
    rte::ScaledStack memory;
    std::vector<double> numbers, matrices;
    rte::find_mirror_reflectances(smooth, cosines, {}, memory, numbers);
    rte::find_mirror_reflectances(smooth, cosines, {3, true}, memory, matrices);
    return kMargin * largest_change({numbers, matrices}, kLeastJudgedFlux);
}

LightChoice chosen_by(const LightChoice& unknown, double change) {
    if (change <= unknown.allowed) {
        return {.left_out = change,
                .reason = fmt::format("values change by less than {:.1g} without it", change)};
    }
    return {.components = 3,
            .reason = fmt::format("without it values would change by up to {:.1g}", change)};
}

/// How light is computed at wavelengths of a scene where more is to be found out than
/// choose_light knows.
class LightChooser {
  public:
    LightChooser(const LayerRequest& request, double hiding, OpticsDemand demand,
                 const Control& control)
        : request_(request), hiding_(hiding), demand_(std::move(demand)), control_(control) {}

    /// Of the wavelengths whose light needs them. Which ones are looked at depends on the scene
    /// alone, not on what of it is known already.
    void by_stand_ins(const std::vector<std::size_t>& wavelengths,
                      std::vector<LitScene>& all) const {
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
        const std::vector<CoarseChange> found = coarse_changes(looked_at, 1.0);
        for (std::size_t i = 0; i < all.size(); ++i) {
            if (!needs(all[i])) continue;
            const std::size_t w = wavelengths[i];
            const auto next = std::lower_bound(looked_at.begin(), looked_at.end(), w);
            const auto k = std::size_t(next - looked_at.begin());
            const double change = *next == w || k == 0
                                      ? found[k].change
                                      : std::max(found[k - 1].change, found[k].change);
            all[i].light = by_stand_in(all[i].light, w, change);
        }
    }

    /// Where matrices take long, those with few sizes may tell that they are not needed.
    void by_coarse_matrices(const std::vector<std::size_t>& wavelengths,
                            std::vector<LitScene>& all) const {
        std::vector<std::size_t> places, some;
        for (std::size_t i = 0; i < all.size(); ++i) {
            if (!all[i].light.begins_coarsely) continue;
            places.push_back(i);
            some.push_back(wavelengths[i]);
        }
        const std::vector<CoarseChange> found = coarse_changes(some, 1.0 / kCoarseMargin);
        for (std::size_t k = 0; k < places.size(); ++k) {
            LightChoice& light = all[places[k]].light;
            const auto [change, averages_converged] = found[k];
            if (averages_converged && kCoarseMargin * change <= light.allowed) {
                light = chosen_by(light, kCoarseMargin * change);
            } else if (change > kCoarseMargin * light.allowed) {
                light = chosen_by(light, change);
            }
        }
    }

    /// By the matrices that `all` have.
    void by_matrices(std::vector<LitScene>& all, const std::vector<std::size_t>& places) const {
        Memories memories;
        run_parallel("polarisation", places.size(), control_, [&](std::size_t i) {
            LitScene& lit = all[places[i]];
            if (!lit.light.needs_matrices) return;
            lit.light = chosen_by(lit.light, change_without(request_, lit.light.allowed,
                                                            lit.optics.stack, memories.local()));
        });
    }

  private:
    using Memories = tbb::enumerable_thread_specific<rte::SolutionMemory>;

    struct CoarseChange {
        double change;
        bool averages_converged;
    };

    /// @param share  of what is allowed, beyond which it must be known
    std::vector<CoarseChange> coarse_changes(const std::vector<std::size_t>& wavelengths,
                                             double share) const {
        OpticsDemand coarse = demand_;
        coarse.polarisation = coarse.stand_ins = true;
        coarse.tolerance = std::max(coarse.tolerance, kCoarseTolerance);
        const std::vector<SceneOptics> optics = visible_optics(
            request_.scene, request_.directions, hiding_, wavelengths, coarse, control_);
        std::vector<CoarseChange> changes(optics.size());
        Memories memories;
        run_parallel("polarisation", optics.size(), control_, [&](std::size_t i) {
            rte::Stack stack = optics[i].stack;
            double change = 0.0;
            if (has_rough_boundary(request_.scene)) {
                const double roughness = stack.boundary->roughness;
                stack.boundary = rte::Boundary{};
                change = change_of_mirrored(stack, request_.directions, roughness);
            }
            const double allowed = share * choose_light(request_, wavelengths[i]).allowed;
            change = std::max(change, change_without(request_, allowed, stack, memories.local()));
            changes[i] = {change, optics[i].converged};
        });
        return changes;
    }

    LightChoice by_stand_in(const LightChoice& unknown, std::size_t w, double change) const {
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
        } else if (matrices_seconds(request_, w) <= kBearableSeconds) {
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
    const LightChooser chooser(request, hiding, demand, control);
    chooser.by_stand_ins(wavelengths, all);
    chooser.by_coarse_matrices(wavelengths, all);
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
        for (std::size_t i = 0; i < places.size(); ++i)
            all[places[i]].optics = std::move(optics[i]);
        chooser.by_matrices(all, places);
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
