// From the spectra that a camera sees to the files that people open.
#pragma once

#include <string>
#include <vector>

#include "pipeline/render/image.h"
#include "pipeline/render/renderer.h"

namespace miebrdf::program {

/// Refuses names whose ending says another format, before anything is computed. Empty: no such
/// picture. @throws UsageError
void check_picture_paths(const std::string& png, const std::string& exr);

/// Linear RGB over the background, or with coverage as alpha.
/// @param background  "R,G,B", "transparent" or "environment"
/// @param exposure    brightens by powers of two
/// @throws UsageError  for another background
render::Image compose(const render::SpectralPicture& picture,
                      const std::vector<double>& wavelength_nm, const std::string& background,
                      double exposure);

/// Channels R, G, B, A, and one for each wavelength named as in spectral OpenEXR files
/// ("S0.550,000000nm"; Fichet et al. 2021).
void write_spectral_exr(const render::SpectralPicture& picture,
                        const std::vector<double>& wavelength_nm, const render::PictureNotes& notes,
                        const std::string& path);

}  // namespace miebrdf::program
