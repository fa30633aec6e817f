// Which sizes an average is taken over.
#pragma once

#include <vector>

#include "mie/size_distribution.h"

namespace miebrdf::mie {

/// Sizes with their share of the geometric cross-section, ascending.
struct SizeNodes {
    std::vector<double> radius_um;
    std::vector<double> area_share;  ///< sums to 1 up to the error of the rule
};

/// Gauss-Legendre in ln r: for efficiencies that are smooth in r (absorbing or small spheres).
SizeNodes smooth_size_nodes(const SizeDistribution& distribution, const RadiusRange& range,
                            int count);

/// Equally spaced sizes, as the ripple of transparent spheres wants them, shifted by `offset` of
/// one spacing, 0 < offset <= 1. Near the ends the spacing shrinks smoothly to zero, so that every
/// offset is as good as the midpoint, and the grids of `count` nodes with offsets o and o + 1/2
/// make together the grid of 2 `count`. For gamma and log-normal the density of nodes follows the
/// cube root of the area density (the least error of a rule whose error goes with the square of the
/// spacing).
SizeNodes even_size_nodes(const SizeDistribution& distribution, const RadiusRange& range, int count,
                          double offset);

}  // namespace miebrdf::mie
