// Gives every layer's coefficients, which formulators read off a scene.
#include <miebrdf/brdf.h>

#include <fmt/format.h>

#include <limits>
#include <numeric>

#include "pipeline/solve/brdf_state.h"
#include "pipeline/solve/rules.h"
#include "pipeline/solve/single_scattering.h"

namespace miebrdf {
namespace {

/// kg/m2 in 1 um of layer (of ratios alone: in any unit); empty where a density is missing.
std::optional<double> mass_per_um(const ResolvedMedium& medium) {
    double sum = 0.0;
    for (const ResolvedSpecies& species : medium.species) {
        if (!species.density_g_cm3) return std::nullopt;
        sum += 1e-3 * species.volume_fraction * *species.density_g_cm3;
    }
    return sum;
}

/// Stands for a layer without particles or without depth, whose particles nobody asks about.
constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();

LayerOptics layer_of(const ResolvedMedium& medium, const MediumOptics& optics) {
    LayerOptics layer;
    layer.single_scattering_albedo = optics.optics.single_scattering_albedo;
    layer.asymmetry = optics.asymmetry;
    if (medium.has_amounts && optics.extinction_per_um == 0.0)
        layer.single_scattering_albedo = layer.asymmetry = kNothing;
    if (!medium.has_extinction()) return layer;
    if (const auto mass = mass_per_um(medium))
        layer.mass_extinction_m2_per_kg = optics.extinction_per_um / *mass;
    if (!medium.has_amounts) return layer;
    const double scattering = optics.extinction_per_um * optics.optics.single_scattering_albedo;
    const double absorption = optics.extinction_per_um * optics.optics.one_minus_albedo;
    const double reduced = scattering * (1.0 - optics.asymmetry);
    layer.scattering_per_um = scattering;
    layer.absorption_per_um = absorption;
    layer.reduced_scattering_per_um = reduced;
    layer.k_km = 2.0 * absorption;
    const double s_km = 0.75 * reduced - 0.25 * absorption;
    if (s_km >= 0.0) layer.s_km = s_km;
    return layer;
}

std::vector<std::size_t> counted_from(std::size_t first, std::size_t end) {
    std::vector<std::size_t> indices(end - first);
    std::iota(indices.begin(), indices.end(), first);
    return indices;
}

}  // namespace

std::vector<LayerOptics> Brdf::layers() const {
    const ResolvedScene& scene = state_->resolved;
    const OpticsDemand demand =
        demand_of(state_->solver, scene.particles.tolerance, PhaseDemand::moments_only);
    const auto wavelengths = counted_from(0, scene.wavelength_nm.size());
    const auto media = counted_from(scene.first_medium(), scene.media.size());
    const auto optics = optics_of(scene, media, wavelengths, demand, state_->control);
    const auto depths = optical_depths_of(scene, wavelengths, demand.tolerance, state_->control);
    std::vector<LayerOptics> all;
    for (const std::size_t w : wavelengths) {
        const auto add = [&](std::size_t m, std::string place, double depth) {
            LayerOptics layer = layer_of(scene.media[m], optics[w][m - scene.first_medium()]);
            layer.wavelength = w;
            layer.layer = std::move(place);
            layer.optical_depth = depth;
            all.push_back(std::move(layer));
        };
        if (!scene.substrate) add(0, "base", std::numeric_limits<double>::infinity());
        std::size_t m = 0;
        for (std::size_t c = 0; c < state_->scene.layers.size(); ++c) {
            const Layer& layer = state_->scene.layers[c];
            if (!is_left_out(state_->scene, layer)) ++m;
            const std::string place = fmt::format("coat {}", c + 1);
            if (layer.depth.value > 0.0) {
                add(m, place, depths[w][m - 1]);
            } else {
                all.push_back({w, place, 0.0, kNothing, kNothing, {}, {}, {}, {}, {}, {}});
            }
        }
    }
    return all;
}

}  // namespace miebrdf
