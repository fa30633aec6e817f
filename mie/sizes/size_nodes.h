// The sizes that an average is taken over: rules of nodes, and pass after pass of more of them.
#pragma once

#include <vector>

#include "mie/sizes/size_law.h"

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
/// make together the grid of 2 `count`. Laws without ends spread their sizes themselves
/// (SizeLaw::radius_at).
SizeNodes even_size_nodes(const SizeDistribution& distribution, const RadiusRange& range, int count,
                          double offset, SizeSpacing spacing = SizeSpacing::equal);

/// Level 0: `first_count` sizes. Level l > 0: those halfway between all sizes of the levels below,
/// so that the mean over levels 0 ... l is the rule of first_count * 2^l sizes.
SizeNodes nested_size_nodes(const SizeDistribution& distribution, const RadiusRange& range,
                            int first_count, int level, SizeSpacing spacing = SizeSpacing::equal);

}  // namespace miebrdf::mie
