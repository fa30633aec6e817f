// Waves of the rays of some groups, as columns of blocks.
#pragma once

#include <complex>
#include <span>

#include "mie/ensemble/ray_phase.h"
#include "mie/ensemble/size_sums.h"

namespace miebrdf::mie {

/// The columns of one group: those of eight sizes way by way (or phase by phase), then those of the
/// next eight.
struct RayColumns {
    const RayGroup* group;  ///< not in closed form
    SphereBlockOf<float>* block;
    double scattered = 0;  ///< as PairedIntensity
};

/// Fills the blocks of groups with the same sizes; a block in which nothing is scattered has no
/// columns. The responses of the boundary, which cost as much as some ten ways, are computed once
/// for all groups.
void put_rays(std::complex<double> relative_index, const WeightedSizes& sizes, int first_size,
              int size_count, std::span<RayColumns> wanted);

}  // namespace miebrdf::mie
