// Which sizes an average is taken over.
#pragma once

#include <vector>

#include <miebrdf/sizes.h>

namespace miebrdf::mie {

/// Sizes with their share of the geometric cross-section, ascending.
struct SizeNodes {
    std::vector<double> radius_um;
    std::vector<double> area_share;  ///< sums to 1 up to the error of the rule
};

/// Gauss-Legendre in ln r: for efficiencies that are smooth in r (absorbing or small spheres).
SizeNodes smooth_size_nodes(const SizeDistribution& distribution, const RadiusRange& range,
                            int count);

/// How the sizes of a power law or a table are spread: equally, as ripple wants it (all resonances
/// of one family are met alike), or in equal ratios, as averages that are smooth in size want it.
enum class SizeSpacing { equal, geometric };

/// Equally spaced sizes, as the ripple of transparent spheres wants them, shifted by `offset` of
/// one spacing, 0 < offset <= 1. Near the ends the spacing shrinks smoothly to zero, so that every
/// offset is as good as the midpoint, and the grids of `count` nodes with offsets o and o + 1/2
/// make together the grid of 2 `count`. For gamma and log-normal the density of nodes follows the
/// cube root of the area density (the least error of a rule whose error goes with the square of the
/// spacing).
SizeNodes even_size_nodes(const SizeDistribution& distribution, const RadiusRange& range, int count,
                          double offset, SizeSpacing spacing = SizeSpacing::equal);

/// Level 0: `first_count` sizes. Level l > 0: those halfway between all sizes of the levels below,
/// so that the mean over levels 0 ... l is the rule of first_count * 2^l sizes.
SizeNodes nested_size_nodes(const SizeDistribution& distribution, const RadiusRange& range,
                            int first_count, int level, SizeSpacing spacing = SizeSpacing::equal);

}  // namespace miebrdf::mie
