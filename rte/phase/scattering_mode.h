// One azimuthal order of what a medium scatters.
#pragma once

#include <algorithm>
#include <cmath>

#include "rte/math/scratch.h"

namespace miebrdf::rte {

/// What the solvers need to know of the medium for one azimuthal order.
struct ScatteringMode {
    math::ScratchVector strengths;  ///< alpha (2l+1) chi_l, l = m ... L - 1
    double one_minus_albedo = 1.0;  ///< its own number
    int lowest_degree = 0;          ///< m

    /// Largest alpha |chi_l|, l >= m: bounds what part of a field one scattering returns, and how
    /// far the equations are from those without scattering.
    double strongest() const {
        double largest = 0.0;
        for (Eigen::Index c = 0; c < strengths.size(); ++c) {
            const double degree = double(lowest_degree + c);
            largest = std::max(largest, std::abs(strengths[c]) / (2.0 * degree + 1.0));
        }
        return largest;
    }
};

}  // namespace miebrdf::rte
