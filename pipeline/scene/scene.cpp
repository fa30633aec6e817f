#include <fmt/format.h>
#include <miebrdf/error.h>
#include <miebrdf/scene.h>

#include <cmath>

#include "pipeline/scene/medium_kinds.h"

namespace miebrdf {
namespace {

void require_positive(double value, const char* field) {
    if (!(value > 0.0 && std::isfinite(value))) throw UsageError(field, value, "finite and > 0");
}

void validate(const ParticleOptions& particles) {
    require_positive(particles.sizes.effective_radius_um, "effective_radius_um");
    if (particles.sizes.kind != mie::SizeDistributionKind::mono)
        require_positive(particles.sizes.effective_variance, "effective_variance");
    require_positive(particles.host_index, "host_index");
    if (!(particles.k_floor >= 0.0 && std::isfinite(particles.k_floor)))
        throw UsageError("k_floor", particles.k_floor, ">= 0");
    if (!(particles.tolerance >= 0.0 && particles.tolerance < 1.0))
        throw UsageError("mie_tolerance", particles.tolerance,
                         "[0, 1); 0: a share of the tolerance");
}

void validate(const Medium& medium, const ParticleOptions& of_scene) {
    validate(medium);
    // Radius and variance of a table are its own: another number would change nothing.
    if (of_scene.sizes.kind == mie::SizeDistributionKind::tabulated &&
        medium.sizes != ParticleSizes{} && !medium.sizes.distribution) {
        throw UsageError(
            fmt::format("medium '{}': the scene's sizes are a table, so a layer with sizes of its "
                        "own needs a distribution, too",
                        describe(medium)));
    }
}

}  // namespace

std::string describe(const Scene& scene) {
    std::string text = describe(scene.base);
    for (const Layer& layer : scene.layers) {
        text = fmt::format("{} (optical depth {}) on {}", describe(layer.medium),
                           layer.optical_depth, text);
    }
    if (scene.surface) text += fmt::format(", surface roughness {}", scene.surface->beckmann_alpha);
    return text;
}

const Medium& top_medium(const Scene& scene) {
    return scene.layers.empty() ? scene.base : scene.layers.back().medium;
}

void validate(const Scene& scene) {
    validate(scene.particles);
    if (scene.surface) rte::validate(*scene.surface);
    validate(scene.base, scene.particles);
    for (const Layer& layer : scene.layers) {
        validate(layer.medium, scene.particles);
        if (!(layer.optical_depth >= 0.0)) {
            throw UsageError(fmt::format("coat {}: optical depth {} is out of range; allowed: >= 0",
                                         describe(layer.medium), layer.optical_depth));
        }
    }
}

}  // namespace miebrdf
