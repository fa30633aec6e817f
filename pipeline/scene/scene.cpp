#include <fmt/format.h>
#include <miebrdf/error.h>
#include <miebrdf/scene.h>

#include <cmath>

#include "pipeline/scene/medium_kinds.h"
#include "pipeline/scene/scene_parts.h"

namespace miebrdf {
namespace {

void require_positive(double value, const char* field) {
    if (!(value > 0.0 && std::isfinite(value))) throw UsageError(field, value, "finite and > 0");
}

void validate(const ParticleOptions& particles) {
    require_positive(particles.sizes.effective_radius_um, "effective_radius_um");
    if (particles.sizes.kind != mie::SizeDistributionKind::mono)
        require_positive(particles.sizes.effective_variance, "effective_variance");
    validate(particles.host);
    if (!(particles.k_floor >= 0.0 && std::isfinite(particles.k_floor)))
        throw UsageError("k_floor", particles.k_floor, ">= 0");
    if (!(particles.tolerance >= 0.0 && particles.tolerance < 1.0))
        throw UsageError("mie_tolerance", particles.tolerance,
                         "[0, 1); 0: a share of the tolerance");
    if (particles.layer_density_kg_m3)
        require_positive(*particles.layer_density_kg_m3, "layer_density_kg_m3");
}

void validate(const Medium& medium, const ParticleOptions& of_scene) {
    validate(medium);
    // Radius and variance of a table are its own: another number would change nothing.
    if (of_scene.sizes.kind != mie::SizeDistributionKind::tabulated) return;
    for (const Species& species : medium.species) {
        if (species.sizes == ParticleSizes{} || species.sizes.distribution) continue;
        throw UsageError(
            fmt::format("medium '{}': the scene's sizes are a table, so a layer with sizes of its "
                        "own needs a distribution, too",
                        describe(medium)));
    }
}

/// "optical depth 0.1", "40um"
std::string depth_text(const Depth& depth) {
    const bool is_optical = depth.kind == Depth::Kind::optical_depth;
    return (is_optical ? "optical depth " : "") + describe(depth);
}

}  // namespace

std::string describe(const Scene& scene) {
    std::string text =
        scene.substrate ? "substrate " + describe(*scene.substrate) : describe(scene.base);
    for (const Layer& layer : scene.layers)
        text = fmt::format("{} ({}) on {}", describe(layer.medium), depth_text(layer.depth), text);
    if (scene.boundary) text += ", boundary " + describe(*scene.boundary);
    if (scene.surface) text += ", surface roughness " + describe(*scene.surface);
    return text;
}

const Medium& top_medium(const Scene& scene) {
    if (!scene.layers.empty()) return scene.layers.back().medium;
    if (scene.substrate) {
        throw UsageError(fmt::format("substrate '{}' has no layers on it; give at least one coat",
                                     describe(*scene.substrate)));
    }
    return scene.base;
}

const Host& host_of(const Scene& scene, const Medium& medium) {
    return medium.host ? *medium.host : scene.particles.host;
}

namespace {

bool is_slide(const Medium& medium) { return medium.species.front().kind == Species::Kind::slide; }

/// A slide without surfaces would be nothing, and one without an end hides all else.
void require_place(const Scene& scene, const Layer& layer) {
    if (!is_slide(layer.medium)) return;
    if (!scene.boundary)
        throw UsageError(fmt::format(
            "coat '{}@{}': a slide reflects at its surfaces, and the scene has none; give the "
            "boundary to the air: boundary smooth",
            describe(layer.medium), describe(layer.depth)));
    if (layer.depth.kind == Depth::Kind::thickness_um || layer.depth.value == 0.0) return;
    throw UsageError(fmt::format("coat '{}@{}': a slide has a thickness; write {}@1mm",
                                 describe(layer.medium), describe(layer.depth),
                                 describe(layer.medium)));
}

}  // namespace

void validate(const Scene& scene) {
    validate(scene.particles);
    if (scene.surface) rte::validate(*scene.surface);
    if (scene.boundary) {
        rte::validate(*scene.boundary);
        if (scene.surface) {
            throw UsageError(
                "a scene has a refracting boundary or the paper's opaque lobe (roughness), not "
                "both: a rough boundary has a lobe of its own");
        }
    }
    if (scene.substrate) {
        validate(*scene.substrate);
        if (scene.boundary && scene.substrate->kind == Substrate::Kind::brdf) {
            throw UsageError(
                fmt::format("substrate '{}' is the BRDF of a ground in air, which a boundary above "
                            "it would change; leave out the boundary, or take lambert:ALBEDO",
                            describe(*scene.substrate)));
        }
        // A ground may be bare, under a boundary or without; nothing at all is no scene.
        const bool needs_layers = scene.substrate->kind == Substrate::Kind::none ||
                                  (scene.surface && !scene.surface_index);
        if (needs_layers && !scene.boundary) top_medium(scene);
    } else {
        validate(scene.base, scene.particles);
        if (is_slide(scene.base))
            throw UsageError(fmt::format(
                "base '{0}': a slide is no half-space; write it as a coat, {0}@1mm, and what lies "
                "below it as the base or substrate (none: air)",
                describe(scene.base)));
    }
    for (const Layer& layer : scene.layers) {
        validate(layer.medium, scene.particles);
        try {
            validate(layer.depth);
        } catch (const UsageError& error) {
            throw UsageError(fmt::format("coat {}: {}", describe(layer.medium), error.what()));
        }
        require_place(scene, layer);
    }
}

}  // namespace miebrdf
