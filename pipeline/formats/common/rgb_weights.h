// Which colour the RGB formats get.
#pragma once

#include "pipeline/solve/rgb_source.h"

namespace miebrdf::exports {

/// Whether a colour can be told from these wavelengths: eight or more, in ascending order, from
/// 430 nm or less to 650 nm or more.
bool covers_the_visible(const std::vector<double>& wavelength_nm);

/// `cie`: linear sRGB of the CIE 1931 observer under D65 (pipeline/colour/colour.h). `wavelengths`:
/// the three wavelengths nearest to 620, 535 and 480 nm. `auto`: cie where they cover the visible,
/// else wavelengths.
/// @throws UsageError  for another word, or cie with wavelengths that do not ascend
RgbWeights rgb_weights(const std::string& mode, const std::vector<double>& wavelength_nm);

}  // namespace miebrdf::exports
