// The chart of a fit: measured points, the fitted curve, and what is between them.
#pragma once

#include <miebrdf/fit.h>

#include "pipeline/plot/picture.h"

namespace miebrdf::program {

/// Spectra over wavelength; without them single directions over the angle of view in the plane of
/// incidence, one colour for each incidence. Residuals of all values below.
plot::Picture draw_fit(const FitProblem& problem, const FitResult& result,
                       const plot::Caption& caption);

/// @throws UsageError  where there is nothing that draw_fit draws: colours alone
void require_drawable(const FitProblem& problem);

}  // namespace miebrdf::program
