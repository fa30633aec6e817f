// Geometric means of symmetric matrices side by side.
#pragma once

#include <algorithm>
#include <cmath>

#include "rte/math/matrices_side_by_side.h"

#ifdef MIEBRDF_HAS_FOUR_DOUBLES

namespace miebrdf::math {

/// The positive definite Z with Z V Z = U, the geometric mean of U and V^-1, and its inverse. With
/// U = F k^2 F^T and V^-1 = F F^T it is F k F^T: arithmetic and harmonic means of both approach it
/// from above and below, their eigenvectors F being the same, twice as many digits with each step;
/// scaled so that the largest and the smallest k are as far off (Byers & Xu 2008, for one matrix).
///
/// @param U, V             n x n, of which the lower triangles are read; they become those of Z and
///                         Z^-1
/// @param lowest, highest  all k are between these, or nearly so
/// @param accuracy         relative
/// @param memory           for 2 n (n + 1)
/// @return false where U or V is not positive definite
template <typename Doubles>
bool find_geometric_means(Doubles* U, Doubles* V, int n, double lowest, double highest,
                          double accuracy, Doubles* memory) {
    constexpr int most_steps = 12;
    Doubles *above = U, *below_inverse = V, *above_inverse = memory, *below = memory + n * n,
            *columns = memory + 2 * n * n;
    for (int j = 0; j < n; ++j) {
        std::copy(above + j * (n + 1), above + (j + 1) * n, above_inverse + j * (n + 1));
        std::copy(below_inverse + j * (n + 1), below_inverse + (j + 1) * n, below + j * (n + 1));
    }
    for (int step = 0; step < most_steps; ++step) {
        invert_each<Part::lower>(above_inverse, n, columns);
        invert_each<Part::lower>(below, n, columns);
        // Both means enclose Z, and their difference is nowhere larger than on its diagonal. What
        // is left after their mean is its square.
        double apart = 0.0;
        for (int j = 0; j < n; ++j) {
            const int here = j * (n + 1);
            const Doubles relative = (above[here] - below[here]) / (above[here] + below[here]);
            for (int k = 0; k < kLanes<Doubles>; ++k)
                apart = std::max(apart, std::abs(relative[k]));
        }
        if (!(apart < 1.0 + 1e-9)) return false;
        const bool is_last = step > 0 && apart * apart <= accuracy;
        const double scale = is_last ? 1.0 : 1.0 / std::sqrt(lowest * highest);
        const double up = 0.5 * scale, down = 0.5 / scale;
        for (int j = 0; j < n; ++j) {
            for (int k = j * (n + 1); k < (j + 1) * n; ++k) {
                const Doubles mean = up * above[k] + down * below[k];
                const Doubles mean_inverse = down * above_inverse[k] + up * below_inverse[k];
                above[k] = above_inverse[k] = mean;
                below_inverse[k] = below[k] = mean_inverse;
            }
        }
        if (is_last) return true;
        const double spread = std::sqrt(highest / lowest);
        lowest = 1.0;
        highest = 0.5 * (spread + 1.0 / spread);
    }
    return false;
}

}  // namespace miebrdf::math

#endif
