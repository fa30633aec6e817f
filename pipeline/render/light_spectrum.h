// Spectra of light relative to white, and colours as spectra.
#pragma once

#include <array>
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

}  // namespace miebrdf::render
