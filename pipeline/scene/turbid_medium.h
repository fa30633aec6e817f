// Media known by what a laboratory measures of them: reduced scattering and absorption per mm.
#pragma once

#include <miebrdf/scene.h>

#include <string>

#include "pipeline/scene/medium_kinds.h"

namespace miebrdf {

/// Reads a paste, the coefficients of a paint or pigment paste over wavelengths, into name,
/// parameters (the asymmetry, and the density in g/cm3 or 0) and scattering (wavelengths,
/// extinction in 1/um and albedo of the paste alone): a CSV file with the columns wavelength_nm,
/// mu_s_reduced and mu_a, both in 1/mm, and the comment lines `# g: 0.7` (0 without), `#
/// density: 1.6` (g/cm3), and
/// `# volume: 10%` or `# weight: 10%` where the coefficients are of a film that the paste fills to
/// this share. A name without a suffix or a slash is one of the embedded set.
/// @throws InputError  with file and line; for an unknown name, with the names that there are
void read_paste(const std::string& name, Species& species);

/// @throws UsageError  for lists that do not fit, negative coefficients and none above 0
void check_paste(const Species& species);

/// Between its wavelengths scattering and absorption are linear.
MediumKind paste();

/// Parameters: mu_a and mu_s (1 - g) in 1/mm, and g, the same at every wavelength.
MediumKind turbid();

}  // namespace miebrdf
