// The BRDF of a scene: values, albedos, tables and derivatives.
#include <fmt/format.h>
#include <miebrdf/brdf.h>
#include <miebrdf/error.h>
#include <miebrdf/transfer.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "pipeline/cache/job_key.h"
#include "pipeline/solve/brdf_state.h"
#include "pipeline/solve/checks.h"
#include "pipeline/solve/layer_derivatives.h"
#include "pipeline/solve/layers.h"
#include "pipeline/solve/optics_memo.h"
#include "pipeline/solve/parallel.h"
#include "pipeline/solve/rules.h"
#include "pipeline/solve/solved_table.h"
#include "pipeline/solve/surface_part.h"

namespace miebrdf {
namespace {

void validate_wavelengths(const std::vector<double>& wavelength_nm) {
    if (wavelength_nm.empty())
        throw UsageError("wavelength_nm", "an empty list", "one or more, in nm");
    for (const double nm : wavelength_nm) {
        if (!(nm > 0.0 && std::isfinite(nm)))
            throw UsageError("wavelength_nm", nm, "finite and > 0");
    }
}

/// Eq. 5: the lobe, and the light of the layers that the surface lets through.
/// @param total  the lobe
std::vector<double> total_of(std::vector<double> total, const SurfacePart& surface,
                             const std::vector<double>& subsurface) {
    const std::size_t azimuths = total.size() / (surface.in.size() * surface.out.size());
    std::size_t index = 0;
    for (const double in : surface.in) {
        for (const double out : surface.out) {
            for (std::size_t a = 0; a < azimuths; ++a, ++index) {
                total[index] += in * out * subsurface[index];
            }
        }
    }
    return total;
}

/// Errors of R relative to the largest at its incidence, as those of R / pi.
std::vector<double> absolute_errors(std::vector<double> errors,
                                    const std::vector<double>& subsurface,
                                    const Directions& directions) {
    errors.resize(subsurface.size(), 0.0);  // closed forms
    const std::size_t block = directions.mu_out.size() * directions.azimuth_deg.size();
    for (std::size_t start = 0; start < errors.size(); start += block) {
        double largest = 0.0;
        for (std::size_t k = start; k < start + block; ++k)
            largest = std::max(largest, std::abs(subsurface[k]));
        for (std::size_t k = start; k < start + block; ++k) errors[k] *= largest;
    }
    return errors;
}

void keep_largest(std::optional<double>& largest, double value) {
    largest = std::max(largest.value_or(0.0), value);
}

/// The largest albedo: A of the layers, rho + (1 - rho) A of the whole (eq. 5). With the reciprocal
/// coupling the whole has that albedo in the mean over incidences only, and none is stated.
void add_energy(BrdfValues::Slice& slice, const std::vector<double>& plane_albedo,
                const SurfacePart* surface, rte::SurfaceCoupling coupling) {
    for (std::size_t i = 0; i < plane_albedo.size(); ++i) {
        keep_largest(slice.layers_physics.largest_albedo, plane_albedo[i]);
        if (surface != nullptr && !surface->in.empty() && coupling == rte::SurfaceCoupling::paper) {
            keep_largest(slice.physics.largest_albedo,
                         1.0 - surface->in[i] + surface->in[i] * plane_albedo[i]);
        }
    }
    if (surface == nullptr) slice.physics.largest_albedo = slice.layers_physics.largest_albedo;
}

void add_physics(BrdfValues::Slice& slice, const Directions& directions) {
    const auto& whole = !slice.total.empty()     ? slice.total
                        : !slice.surface.empty() ? slice.surface
                                                 : slice.subsurface;
    if (!slice.subsurface.empty()) slice.layers_physics = physics_of(slice.subsurface, directions);
    if (!whole.empty()) slice.physics = physics_of(whole, directions);
}

/// The lobe and transmission of the surface; nothing where the parts wanted have none.
std::optional<SurfacePart> surface_of(const ResolvedScene& scene, std::size_t w,
                                      const Directions& directions, const BrdfParts& parts,
                                      const Control& control) {
    if (!wants_lobe(scene, parts)) return {};
    const auto demand = parts.total ? SurfaceDemand::whole : SurfaceDemand::lobe;
    return surface_part(scene, w, directions, demand, control);
}

/// The parts wanted of a BRDF at one wavelength.
/// @param surface  surface_of()
BrdfValues::Slice slice_of(LayerSlice layer, const ResolvedScene& scene,
                           const std::optional<SurfacePart>& surface, const Directions& directions,
                           const BrdfParts& parts) {
    BrdfValues::Slice slice;
    slice.subsurface = std::move(layer.values);
    slice.mirror_reflectance = std::move(layer.mirror_reflectance);
    for (double& value : slice.subsurface) value /= std::numbers::pi;
    if (parts.errors) {
        slice.errors = absolute_errors(std::move(layer.errors), slice.subsurface, directions);
        if (surface) {
            slice.errors =
                total_of(std::vector<double>(slice.errors.size(), 0.0), *surface, slice.errors);
        }
    }
    if (surface) {
        if (parts.total) slice.total = total_of(surface->lobe, *surface, slice.subsurface);
        if (parts.surface) slice.surface = surface->lobe;
    }
    add_physics(slice, directions);
    add_energy(slice, layer.plane_albedo, surface ? &*surface : nullptr, scene.coupling);
    // Without a surface the whole is the layers: their list is copied only if both are wanted.
    if (!scene.surface && parts.total) {
        slice.total = parts.subsurface ? slice.subsurface : std::move(slice.subsurface);
    }
    if (!parts.subsurface) slice.subsurface = {};
    return slice;
}

/// The layers, solved where the parts wanted need them.
std::vector<LayerSlice> layers_of(const BrdfState& state, const Directions& directions,
                                  const BrdfParts& parts) {
    const ResolvedScene& scene = state.resolved;
    if (!wants_layers(parts)) return without_values(scene);
    return compute_layers({.scene = scene,
                           .directions = directions,
                           .solver = state.solver,
                           .keeps_errors = parts.errors},
                          state.control);
}

BrdfValues brdf_values(std::vector<LayerSlice> layers, const BrdfState& state,
                       const Directions& directions, const BrdfParts& parts) {
    const ResolvedScene& scene = state.resolved;
    BrdfValues values;
    values.directions = directions;
    values.tolerance = state.solver.tolerance;
    values.sources = scene.sources;
    values.notes = scene.notes;
    for (const LayerSlice& layer : layers) values.wavelengths.push_back(layer.report);
    values.slices.resize(layers.size());
    if (has_no_pairs(directions)) return values;
    run_parallel("surface", layers.size(), state.control, [&](std::size_t w) {
        values.slices[w] =
            slice_of(std::move(layers[w]), scene,
                     surface_of(scene, w, directions, parts, state.control), directions, parts);
    });
    return values;
}

/// Splits the values of layers (LayerSlice) into the lists of AlbedoValues.
AlbedoValues albedo_values(std::vector<LayerSlice> layers, const ResolvedScene& scene,
                           const std::vector<double>& mu_in, const SolverOptions& solver) {
    AlbedoValues values;
    values.mu_in = mu_in;
    for (LayerSlice& layer : layers) {
        values.wavelengths.push_back(layer.report);
        values.spherical_albedo.push_back(layer.values.back());
        layer.values.pop_back();
        values.plane_albedo.push_back(std::move(layer.values));
        if (!layer.mirror_reflectance.empty())
            values.mirror_reflectance.push_back(std::move(layer.mirror_reflectance));
        if (solver.stokes > 1)
            values.polarised_plane_albedo.push_back(std::move(layer.polarised_plane_albedo));
        if (!scene.substrate || scene.surface) continue;
        values.spherical_transmittance.push_back(layer.transmittance.back());
        layer.transmittance.pop_back();
        values.plane_transmittance.push_back(std::move(layer.transmittance));
        values.unscattered_transmittance.push_back(std::move(layer.unscattered_transmittance));
    }
    return values;
}

/// @param layers  of albedo_quantity(), without the surface
AlbedoValues albedo_of(const BrdfState& state, std::vector<LayerSlice> layers,
                       const std::vector<double>& mu_in) {
    const ResolvedScene& scene = state.resolved;
    if (scene.surface && !layers.empty()) {
        const SurfaceOverAlbedos surface(scene, mu_in, all_wavelengths(scene), state.control);
        for (std::size_t w = 0; w < layers.size(); ++w) surface.add_to(w, layers[w].values);
    }
    AlbedoValues values = albedo_values(std::move(layers), scene, mu_in, state.solver);
    values.tolerance = state.solver.tolerance;
    values.sources = scene.sources;
    values.notes = scene.notes;
    return values;
}

using Numbers = std::vector<double>;

/// values + step * slope; an empty slope is 0.
Numbers moved(const Numbers& values, const Numbers& slope, double step) {
    Numbers result = values;
    for (std::size_t k = 0; k < slope.size() && k < result.size(); ++k)
        result[k] += step * slope[k];
    return result;
}

Numbers slope(const Numbers& plus, const Numbers& minus, double apart) {
    Numbers result(plus.size());
    for (std::size_t k = 0; k < result.size() && apart != 0.0; ++k)
        result[k] = (plus[k] - minus[k]) / apart;
    return result;
}

/// The lists of a slice that have derivatives by numbers of the scene.
constexpr Numbers LayerSlice::*kListsWithSlopes[] = {
    &LayerSlice::values, &LayerSlice::transmittance, &LayerSlice::unscattered_transmittance,
    &LayerSlice::mirror_reflectance, &LayerSlice::polarised_plane_albedo};

/// The layers with a number of the scene changed by `step`.
LayerSlice moved(const LayerSlice& values, const LayerSlice& slope, double step) {
    LayerSlice result;
    for (const auto list : kListsWithSlopes) result.*list = moved(values.*list, slope.*list, step);
    return result;
}

/// Names all that the surface depends on: a change of the layers alone leaves it as it is.
std::string surface_key(const ResolvedScene& scene, std::size_t w) {
    JobKey key("surface");
    if (scene.surface) add_surface(key, scene, w);
    return key.hash();
}

/// put_together(layers, scene) on both sides of a change, at one wavelength.
template <typename PutTogether>
auto both_sides(const LayerSlice& values, const LayerSlice& slope, const SceneChange& change,
                std::size_t w, const PutTogether& put_together) {
    const double half = 0.5 * change.apart[w];
    return std::pair(put_together(moved(values, slope, half), change.plus),
                     put_together(moved(values, slope, -half), change.minus));
}

}  // namespace

Brdf solve(const Scene& scene, const std::vector<double>& wavelength_nm,
           const SolverOptions& options, const Control& control) {
    validate(scene);
    validate_wavelengths(wavelength_nm);
    rte::validate(options);
    NamedIndexMemo* const names = control.memo != nullptr ? &control.memo->names() : nullptr;
    BrdfState state{scene, resolve(scene, wavelength_nm, names), options, control, 0};
    if (state.control.memo == nullptr) state.control.memo = make_optics_memo();
    return BrdfState::brdf_with(std::move(state));
}

BrdfValues Brdf::evaluate(const Directions& directions, const BrdfParts& parts) const {
    rte::validate(directions);
    return brdf_values(layers_of(*state_, directions, parts), *state_, directions, parts);
}

AlbedoValues Brdf::albedo(const std::vector<double>& mu_in) const {
    rte::validate(Directions{mu_in, {}, {}});
    const ResolvedScene& scene = state_->resolved;
    std::vector<LayerSlice> layers = compute_layers(
        {scene, {mu_in, {}, {}}, state_->solver, albedo_quantity(scene)}, state_->control);
    return albedo_of(*state_, std::move(layers), mu_in);
}

BrdfTable Brdf::table(const TableOptions& options) const {
    if (options.part == BrdfPart::surface && !state_->resolved.surface) {
        throw UsageError("component 'surface' needs a surface; give a roughness, e.g. 0.3");
    }
    SolverOptions solver = state_->solver;
    if (solver.stokes == 0 && options.whole_matrix) solver.stokes = 4;
    ResolvedScene resolved = state_->resolved;
    std::string title = describe(state_->scene);
    TableOptions told = options;
    if (resolved.surface) {
        const auto chosen = options.coupling ? options.coupling : state_->scene.coupling;
        resolved.coupling = chosen.value_or(rte::SurfaceCoupling::reciprocal);
        title += resolved.coupling == rte::SurfaceCoupling::paper ? ", coupling paper"
                                                                  : ", coupling reciprocal";
    }
    if (told.command_line.empty()) {
        told.command_line =
            fmt::format("Brdf::table of '{}', {} to {} nm, tolerance {}", title,
                        wavelength_nm().front(), wavelength_nm().back(), solver.tolerance);
    }
    return BrdfTable(std::make_shared<const SolvedTable>(resolved, title, solver, told,
                                                         state_->control, state_->unchecked_nodes));
}

ResultReport Brdf::report() const {
    return evaluate(probe_directions(), {.subsurface = true, .surface = false, .total = false});
}

const Scene& Brdf::scene() const { return state_->scene; }
const std::vector<double>& Brdf::wavelength_nm() const { return state_->resolved.wavelength_nm; }
const SolverOptions& Brdf::options() const { return state_->solver; }
const std::vector<std::string>& Brdf::sources() const { return state_->resolved.sources; }

// Derivatives: of the layers by closed forms, of the whole by putting the surface on layers that
// are changed by half a step up and down.

struct BrdfDerivatives::State {
    std::shared_ptr<const BrdfState> brdf;
    std::vector<std::string> parameters;
    std::vector<SceneChange> changes;
};

BrdfDerivatives Brdf::derivatives(const std::vector<std::string>& parameters) const {
    auto state = std::make_shared<BrdfDerivatives::State>();
    state->brdf = state_;
    state->parameters = parameters;
    state->changes.reserve(parameters.size());
    for (auto name = parameters.begin(); name != parameters.end(); ++name) {
        if (std::find(parameters.begin(), name, *name) != name)
            throw UsageError("derivatives by '" + *name + "' are asked for twice");
        state->changes.push_back(change_of(*state_, *name));
    }
    return BrdfDerivatives(std::move(state));
}

const std::vector<std::string>& BrdfDerivatives::parameters() const { return state_->parameters; }

WithDerivatives<BrdfValues> BrdfDerivatives::evaluate(const Directions& directions,
                                                      const BrdfParts& parts) const {
    rte::validate(directions);
    const BrdfState& brdf = *state_->brdf;
    const std::vector<LayerSlice> layers = layers_of(brdf, directions, parts);
    WithDerivatives<BrdfValues> all{
        brdf_values(layers, brdf, directions, parts), state_->parameters, {}};
    if (has_no_pairs(directions)) {
        BrdfValues none;
        none.directions = directions;
        none.slices.resize(layers.size());
        all.derivatives.assign(state_->changes.size(), none);
        return all;
    }
    const auto slopes =
        layer_derivatives({brdf.resolved, directions, brdf.solver, LayerQuantity::reflection},
                          layers, state_->changes, brdf.control);
    for (std::size_t c = 0; c < slopes.size(); ++c) {
        BrdfValues& derivative = all.derivatives.emplace_back();
        derivative.directions = directions;
        derivative.slices.resize(layers.size());
    }
    run_parallel("surface", layers.size(), brdf.control, [&](std::size_t w) {
        const auto surface = surface_of(brdf.resolved, w, directions, parts, brdf.control);
        const std::string key = surface_key(brdf.resolved, w);
        for (std::size_t c = 0; c < slopes.size(); ++c) {
            const SceneChange& change = state_->changes[c];
            const auto [plus, minus] = both_sides(
                layers[w], slopes[c][w], change, w,
                [&](LayerSlice layer, const ResolvedScene& scene) {
                    return slice_of(std::move(layer), scene,
                                    surface_key(scene, w) == key
                                        ? surface
                                        : surface_of(scene, w, directions, parts, brdf.control),
                                    directions, parts);
                });
            const double apart = change.apart[w];
            BrdfValues::Slice& slice = all.derivatives[c].slices[w];
            slice.subsurface = slope(plus.subsurface, minus.subsurface, apart);
            slice.surface = slope(plus.surface, minus.surface, apart);
            slice.total = slope(plus.total, minus.total, apart);
            slice.mirror_reflectance =
                slope(plus.mirror_reflectance, minus.mirror_reflectance, apart);
        }
    });
    return all;
}

WithDerivatives<AlbedoValues> BrdfDerivatives::albedo(const std::vector<double>& mu_in) const {
    const BrdfState& brdf = *state_->brdf;
    const LayerRequest request{
        brdf.resolved, {mu_in, {}, {}}, brdf.solver, albedo_quantity(brdf.resolved)};
    rte::validate(request.directions);
    const std::vector<LayerSlice> layers = compute_layers(request, brdf.control);
    WithDerivatives<AlbedoValues> all{albedo_of(brdf, layers, mu_in), state_->parameters, {}};
    const auto slopes = layer_derivatives(request, layers, state_->changes, brdf.control);
    for (std::size_t c = 0; c < slopes.size(); ++c) {
        std::vector<LayerSlice> whole(layers.size());
        run_parallel("surface", layers.size(), brdf.control, [&](std::size_t w) {
            const SceneChange& change = state_->changes[c];
            const auto [plus, minus] = both_sides(
                layers[w], slopes[c][w], change, w,
                [&](LayerSlice layer, const ResolvedScene& scene) {
                    if (scene.surface)
                        SurfaceOverAlbedos(scene, mu_in, {w}, brdf.control).add_to(w, layer.values);
                    return layer;
                });
            const double apart = change.apart[w];
            for (const auto list : kListsWithSlopes)
                whole[w].*list = slope(plus.*list, minus.*list, apart);
        });
        AlbedoValues& derivative = all.derivatives.emplace_back(
            albedo_values(std::move(whole), brdf.resolved, mu_in, brdf.solver));
        derivative.wavelengths.clear();
    }
    return all;
}

}  // namespace miebrdf
