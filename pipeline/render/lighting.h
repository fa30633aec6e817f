// Spectra of light relative to white, and colours as spectra.
#pragma once

#include <Eigen/Core>

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/render/environment.h"
#include "pipeline/render/image.h"

namespace miebrdf::render {

/// All radiances of the renderer are relative to the white of the picture, D65: a light of 1 at
/// every wavelength is daylight, and a white Lambertian under it is white.

/// `white` (D65 itself), `equal` (energy) or `blackbody:KELVIN` (500 to 40000); 1 at 560 nm.
/// @throws UsageError
Spectrum light_spectrum(const std::string& text, const std::vector<double>& wavelength_nm);

/// Whether the picture has exactly three wavelengths, which then are red, green and blue
/// themselves, in descending order of wavelength, as in Chen et al. (2013).
bool is_rgb(const std::vector<double>& wavelength_nm);

/// For red, green and blue of linear sRGB a spectrum each, so that any combination has the colour
/// it is made of and white is 1 everywhere: of all such spectra the one with the smallest sum of
/// squared steps between neighbouring wavelengths. Saturated colours may go below 0.
/// @throws UsageError  for fewer than three wavelengths
std::array<Spectrum, 3> colour_basis(const std::vector<double>& wavelength_nm);

/// Linear sRGB of each pixel, three channels: the CIE 1931 observer (pipeline/colour/colour.h), or
/// the three wavelengths themselves (is_rgb).
Image to_linear_srgb(const Image& radiance, const std::vector<double>& wavelength_nm);

// Everything that shines on an object.

/// Parallel light, as from the sun.
struct DirectionalLight {
    Eigen::Vector3d towards;  ///< unit vector from the object to the light
    Spectrum irradiance;      ///< on a surface that faces the light
};

/// A rectangle that shines evenly from its front; it is not seen by the camera, nor in mirror-like
/// reflections other than through its light.
struct AreaLight {
    Eigen::Vector3d centre;
    Eigen::Vector3d half_width;   ///< from the centre to the middle of an edge
    Eigen::Vector3d half_height;  ///< likewise, perpendicular to half_width
    Spectrum radiance;            ///< on the side of half_width x half_height
};

struct Lighting {
    std::vector<DirectionalLight> directional;
    std::vector<AreaLight> area;
    std::optional<Environment> environment;
};

/// A square that faces `target`.
/// @param towards   unit vector from the target to the light
/// @param distance  of its centre from the target
/// @param size_deg  angle under which its sides appear from the target, in (0, 150]
/// @param irradiance  at the target, on a surface that faces the light
AreaLight square_light(const Eigen::Vector3d& target, const Eigen::Vector3d& towards,
                       double distance, double size_deg, const Spectrum& irradiance);

}  // namespace miebrdf::render
