// Values of a Brdf with derivatives: the layers by closed forms, what lies on them by the formulas
// that put it on.
#include <miebrdf/brdf.h>
#include <miebrdf/error.h>

#include <algorithm>
#include <string>
#include <utility>

#include <miebrdf/transfer.h>

#include "pipeline/cache/job_key.h"
#include "pipeline/solve/brdf_parts.h"
#include "pipeline/solve/brdf_state.h"
#include "pipeline/solve/layer_derivatives.h"
#include "pipeline/solve/parallel.h"
#include "pipeline/solve/rules.h"
#include "pipeline/solve/scene_changes.h"
#include "pipeline/solve/surface_part.h"

namespace miebrdf {

struct BrdfDerivatives::State {
    std::shared_ptr<const BrdfState> brdf;
    std::vector<std::string> parameters;
    std::vector<SceneChange> changes;
};

namespace {

using Numbers = std::vector<double>;

/// values + step * slope; where there is no slope, the values.
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

/// The layers of the scene that has a little more or less of something.
LayerSlice moved(const LayerSlice& values, const LayerSlice& slope, double step) {
    LayerSlice result;
    result.values = moved(values.values, slope.values, step);
    result.transmittance = moved(values.transmittance, slope.transmittance, step);
    result.mirror_reflectance = moved(values.mirror_reflectance, slope.mirror_reflectance, step);
    result.polarised_plane_albedo =
        moved(values.polarised_plane_albedo, slope.polarised_plane_albedo, step);
    return result;
}

/// Numbers of the layers leave the surface as it is.
std::string surface_key(const ResolvedScene& scene, std::size_t w) {
    JobKey key("surface");
    if (scene.surface) add_surface(key, scene, w);
    return key.hash();
}

/// Derivatives of what `put_together` makes of layers and surface, at one wavelength of one change.
template <typename PutTogether>
auto both_sides(const LayerSlice& values, const LayerSlice& slope, const SceneChange& change,
                std::size_t w, const PutTogether& put_together) {
    const double half = 0.5 * change.apart[w];
    return std::pair(put_together(moved(values, slope, half), change.plus),
                     put_together(moved(values, slope, -half), change.minus));
}

}  // namespace

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
            whole[w].values = slope(plus.values, minus.values, apart);
            whole[w].transmittance = slope(plus.transmittance, minus.transmittance, apart);
            whole[w].mirror_reflectance =
                slope(plus.mirror_reflectance, minus.mirror_reflectance, apart);
            whole[w].polarised_plane_albedo =
                slope(plus.polarised_plane_albedo, minus.polarised_plane_albedo, apart);
        });
        AlbedoValues& derivative = all.derivatives.emplace_back(
            albedo_values(std::move(whole), brdf.resolved, mu_in, brdf.solver));
        derivative.wavelengths.clear();
    }
    return all;
}

}  // namespace miebrdf
