// Spectral path tracing of one object: light transport between lights, object and camera.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "pipeline/render/camera.h"
#include "pipeline/render/lighting.h"
#include "pipeline/render/material_map.h"
#include "pipeline/render/render_brdf.h"
#include "pipeline/solve/run_control.h"

namespace miebrdf::render {

/// What is in the picture. All spectra have one value for each wavelength of the materials.
struct RenderScene {
    RayScene object;
    MaterialMap map;
    std::vector<std::shared_ptr<const RenderBrdf>> materials;
    Lighting lighting;
};

struct RenderOptions {
    int width = 512;
    int height = 512;
    int samples = 64;                  ///< paths for each pixel; powers of two are spread best
    int bounces = 4;                   ///< most reflections of a path; 1: direct light only
    bool environment_visible = false;  ///< behind the object; else nothing is there
    std::uint32_t seed = 0;
};

/// Radiance at each wavelength, seen by each pixel.
struct SpectralPicture {
    Image radiance;  ///< one channel for each wavelength; what is seen past the object counts as 0
                     ///< unless the environment is visible
    Image coverage;  ///< one channel: share of the pixel that the object (or a visible environment)
                     ///< fills
    double noise = 0.0;  ///< estimated rms error of a pixel's sum over wavelengths relative to its
                         ///< mean over the object, from the difference of two halves of the samples
};

/// Paths start at the camera; at each reflection lights are sampled directly and the BRDF is
/// sampled for what comes next, both combined by the balance heuristic (Veach & Guibas 1995) where
/// an environment could be met either way. Reflections beyond `bounces` are left out. The result
/// does not depend on the number of threads, bit for bit.
/// @throws std::invalid_argument  for options out of range or spectra of different lengths
/// @throws Cancelled
SpectralPicture render_picture(const RenderScene& scene, const Camera& camera,
                               const RenderOptions& options, const RunControl& control = {});

}  // namespace miebrdf::render
