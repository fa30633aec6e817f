// Where a picture is taken from.
#pragma once

#include <miebrdf/control.h>

#include <cstdint>
#include <memory>
#include <vector>

#include "pipeline/render/lighting.h"
#include "pipeline/render/material_map.h"
#include "pipeline/render/ray_scene.h"
#include "pipeline/render/render_brdf.h"

namespace miebrdf::render {

class Camera {
  public:
    /// Looks at the middle of an object from a direction, y up, so that its bounding sphere fits
    /// the shorter side of the picture.
    /// @param towards_camera     unit vector from the object, not along y
    /// @param field_of_view_deg  of the shorter side, in (0, 120]; 0: parallel rays (orthographic)
    /// @param zoom               > 1: closer than the bounding sphere needs
    /// @param aspect             width / height of the picture
    Camera(const Bounds& object, const Eigen::Vector3d& towards_camera, double field_of_view_deg,
           double zoom, double aspect);

    /// @param x, y  position in the picture, both in [0, 1], from the upper left corner
    Ray ray(double x, double y) const;

  private:
    Eigen::Vector3d eye_;
    Eigen::Vector3d forward_;
    Eigen::Vector3d right_;  ///< half the picture's width at distance 1 (or anywhere, orthographic)
    Eigen::Vector3d up_;
    bool orthographic_;
};

// Spectral path tracing of one object: light transport between lights, object and camera.

/// Everything in the picture. All spectra have one value for each wavelength of the materials.
struct RenderScene {
    RayScene object;
    MaterialMap map;
    std::vector<std::shared_ptr<const RenderBrdf>> materials;
    Lighting lighting;
};

/// Limit of a picture's sides, in pixels: their numbers must fit the samples' sequence.
inline constexpr int kLongestSide = 16384;

struct RenderOptions {
    int width = 512;   ///< in [1, kLongestSide]
    int height = 512;  ///< likewise
    int samples = 64;  ///< paths for each pixel; powers of two are spread best
    int bounces = 4;   ///< most reflections of a path; 1: direct light only
    /// Largest mean radiance (over the wavelengths) that one path may bring of light reflected
    /// twice and more, > 0: rare paths that bring more are weakened to it, which takes away
    /// fireflies and darkens; 0: none is. Light reflected once is never weakened.
    double clamp = 0.0;
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
    double clamped = 0.0;  ///< share of the light that RenderOptions::clamp took away
};

/// Paths start at the camera; at each reflection lights are sampled directly and the BRDF is
/// sampled for what comes next, both combined by the balance heuristic (Veach & Guibas 1995) where
/// an environment could be met either way. Reflections beyond `bounces` are left out. The result
/// does not depend on the number of threads, bit for bit.
/// @throws std::invalid_argument  for options out of range or spectra of different lengths
/// @throws Cancelled
SpectralPicture render_picture(const RenderScene& scene, const Camera& camera,
                               const RenderOptions& options, const Control& control = {});

}  // namespace miebrdf::render
