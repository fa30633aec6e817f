// Everything that a user can ask for about one scene, as one value.
#pragma once

#include <complex>
#include <optional>
#include <string>
#include <vector>

#include <miebrdf/surface.h>
#include "pipeline/scene/medium.h"
#include "rte/stack/layered_reflection.h"

namespace miebrdf {

/// A base, coats in painting order and, if wanted, a rough surface on top.
struct Scene {
    Medium base;
    std::vector<CoatMedium> coats;
    ParticleOptions particles;                   ///< of layers that have no sizes of their own
    std::optional<rte::SurfaceOptions> surface;  ///< empty: no lobe, all light enters
    rte::SurfaceCoupling coupling = rte::SurfaceCoupling::paper;
    /// Index of the surface where the top medium has none of its own (hg:, isotropic:, ...), or
    /// where it should differ.
    std::optional<std::complex<double>> surface_index;
};

/// Which parts of a BRDF are wanted; the others are neither computed nor returned.
struct BrdfParts {
    bool subsurface = true;
    bool surface = true;  ///< the lobe; there is none without Scene::surface
    bool total = true;
};

struct Request {
    Scene scene;
    std::vector<double> wavelength_nm;
    rte::Directions directions;
    BrdfParts parts;  ///< of compute_brdf
    rte::SolverOptions solver;
    std::string database;  ///< of the user's materials; empty: the default one
};

/// Refuses what no stage could compute, before any work is done.
/// @throws UsageError  with the value and the allowed range
void validate(const Request& request);

/// The medium on top of a scene: that of the last coat, or the base.
const Medium& top_medium(const Scene& scene);

}  // namespace miebrdf
