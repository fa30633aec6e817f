// A request as the methods that average over sizes see it.
#pragma once

#include <complex>
#include <vector>

#include <miebrdf/ensemble.h>
#include "mie/sizes/size_law.h"

namespace miebrdf::mie {

/// Spheres and their sizes.
struct EnsembleProblem {
    std::complex<double> relative_index;
    SizeDistribution sizes;
    RadiusRange range;              ///< of the sizes that are summed
    double share = 1;               ///< of the geometric cross-section, inside the range
    double wave_number_per_um = 0;  ///< 2 pi n_host / lambda
};

/// @throws UsageError  with the value and what is allowed; angles are checked by require_angles
void validate(const EnsembleRequest& request);
void require_angles(const std::vector<double>& angles_deg);

/// Of a valid request.
EnsembleProblem problem_of(const EnsembleRequest& request);

/// What a size distribution without ends leaves out: well below what is asked of the result.
double tail_for(const EnsembleRequest& request);
std::complex<double> relative_index_of(const EnsembleRequest& request);
double wave_number_per_um(const EnsembleRequest& request);
RadiusRange range_of(const EnsembleRequest& request);

}  // namespace miebrdf::mie
