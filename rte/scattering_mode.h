// One azimuthal order of what a medium scatters.
#pragma once

#include "rte/math/scratch.h"

namespace miebrdf::rte {

/// What the solvers need to know of the medium for one azimuthal order.
struct ScatteringMode {
    math::ScratchVector strengths;  ///< alpha (2l+1) chi_l, l = m ... L - 1
    double one_minus_albedo = 1.0;  ///< its own number
    int lowest_degree = 0;          ///< m
};

}  // namespace miebrdf::rte
