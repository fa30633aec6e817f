// Media known by what a laboratory measures of them: reduced scattering and absorption per mm.
#pragma once

#include "pipeline/scene/medium_kinds.h"

namespace miebrdf {

/// The coefficients of a paint or pigment paste over wavelengths, linear between them: of the
/// embedded set by a name without a suffix or a slash, or from a CSV file with the columns
/// wavelength_nm, mu_s_reduced and mu_a, both in 1/mm, and the comment lines `# g: 0.7` (0
/// without),
/// `# density: 1.6` (g/cm3), and `# volume: 10%` or `# weight: 10%` where the coefficients are of a
/// film that the paste fills to this share. Parameters: the asymmetry, and the density or 0.
MediumKind paste();

/// Names of the embedded set.
std::vector<std::string> embedded_paste_names();

/// Parameters: mu_a and mu_s (1 - g) in 1/mm, and g, the same at every wavelength.
MediumKind turbid();

}  // namespace miebrdf
