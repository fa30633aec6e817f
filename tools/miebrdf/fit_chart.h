// The chart of a fit: measured points, the fitted curve, and what is between them.
#pragma once

#include <miebrdf/fit.h>

#include "pipeline/plot/picture.h"

namespace miebrdf::program {

/// Spectra over wavelength; without them single directions over the angle of view in the plane of
/// incidence, one colour for each incidence. Residuals of all values below.
/// @throws UsageError  where there is neither (colours alone)
plot::Picture draw_fit(const FitProblem& problem, const FitResult& result,
                       const plot::Caption& caption);

}  // namespace miebrdf::program
