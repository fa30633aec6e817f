// The BRDF of a scene: one solver for everyone who wants values, albedos or tables of it.
#include <fmt/format.h>
#include <miebrdf/brdf.h>
#include <miebrdf/error.h>
#include <miebrdf/transfer.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "pipeline/solve/brdf_parts.h"
#include "pipeline/solve/brdf_state.h"
#include "pipeline/solve/checks.h"
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

/// The lobe and what it lets through of the layers: eq. 5.
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

void raise(std::optional<double>& largest, double value) {
    largest = std::max(largest.value_or(0.0), value);
}

/// The largest share of light that comes back: of the layers A, of the whole rho + (1 - rho) A
/// (eq. 5; the reciprocal coupling gives that in the mean over incidences only, so it is left out).
void add_energy(BrdfValues::Slice& slice, const std::vector<double>& plane_albedo,
                const SurfacePart* surface, rte::SurfaceCoupling coupling) {
    for (std::size_t i = 0; i < plane_albedo.size(); ++i) {
        raise(slice.layers_physics.largest_albedo, plane_albedo[i]);
        if (surface != nullptr && !surface->in.empty() && coupling == rte::SurfaceCoupling::paper) {
            raise(slice.physics.largest_albedo,
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

}  // namespace

std::optional<SurfacePart> surface_of(const ResolvedScene& scene, std::size_t w,
                                      const Directions& directions, const BrdfParts& parts,
                                      const Control& control) {
    if (!wants_lobe(scene, parts)) return {};
    const auto demand = parts.total ? SurfaceDemand::whole : SurfaceDemand::lobe;
    return surface_part(scene, w, directions, demand, control);
}

BrdfValues::Slice slice_of(LayerSlice layer, const ResolvedScene& scene,
                           const std::optional<SurfacePart>& surface, const Directions& directions,
                           const BrdfParts& parts) {
    BrdfValues::Slice slice;
    slice.subsurface = std::move(layer.values);
    slice.mirror_reflectance = std::move(layer.mirror_reflectance);
    for (double& value : slice.subsurface) value /= std::numbers::pi;
    if (surface) {
        if (parts.total) slice.total = total_of(surface->lobe, *surface, slice.subsurface);
        if (parts.surface) slice.surface = surface->lobe;
    }
    add_physics(slice, directions);
    add_energy(slice, layer.plane_albedo, surface ? &*surface : nullptr, scene.coupling);
    // Without a surface the whole is the layers: one list, if nobody asked for both.
    if (!scene.surface && parts.total) {
        slice.total = parts.subsurface ? slice.subsurface : std::move(slice.subsurface);
    }
    if (!parts.subsurface) slice.subsurface = {};
    return slice;
}

std::vector<LayerSlice> layers_of(const BrdfState& state, const Directions& directions,
                                  const BrdfParts& parts) {
    const ResolvedScene& scene = state.resolved;
    if (!wants_layers(parts)) return without_values(scene);
    return compute_layers({scene, directions, state.solver, LayerQuantity::reflection},
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
        const auto spherical = layer.transmittance.begin() + std::ptrdiff_t(mu_in.size());
        values.spherical_transmittance.push_back(*spherical);
        values.unscattered_transmittance.emplace_back(spherical + 1, layer.transmittance.end());
        layer.transmittance.resize(mu_in.size());
        values.plane_transmittance.push_back(std::move(layer.transmittance));
    }
    return values;
}

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

}  // namespace miebrdf
