// Sums over sizes, and what they differ by where the sizes count otherwise or the spheres change.
#pragma once

#include <vector>

#include "mie/ensemble/size_sums.h"

namespace miebrdf::mie {

/// Spheres at given radii, one way or the other.
struct SpheresAtRadii {
    Scatterer scatterer;
    double x_per_um = 0;             ///< size parameter of a radius
    std::vector<double> area_share;  ///< of the geometric cross-section, one for each radius
};

/// A sum over sizes with a number a little larger and a little smaller.
struct SpheresChange {
    SpheresAtRadii plus, minus;
    bool spheres_differ = false;  ///< and not the shares alone
};

struct ChangedSums {
    SizeSums middle;
    std::vector<SizeSums> differences;  ///< plus minus minus, of each change
};

/// All sums are quadratic in the waves of the spheres: other shares weigh the same waves, and
/// changed waves count by their product with those in the middle. One pass over the spheres serves
/// all changes of shares, and each change of spheres needs one more. Angles have products: two
/// columns, four with the matrix.
/// @param radius_um  ascending
/// @param options    of these: terms, band_width, with_matrix
/// @param angles     null: none
template <typename Scalar>
ChangedSums sums_with_changes(const std::vector<double>& radius_um, const SpheresAtRadii& middle,
                              const std::vector<SpheresChange>& changes,
                              const SizeSumOptions& options,
                              const AngularFunctionsOf<Scalar>* angles, const Executor& run);

}  // namespace miebrdf::mie
