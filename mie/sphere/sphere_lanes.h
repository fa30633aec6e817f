// Eight spheres of one index at once, one in each lane.
#pragma once

#include <complex>

#include "mie/sphere/lanes.h"
#include "mie/sphere/sphere_block.h"

namespace miebrdf::mie {

/// The sums of SphereSums for each lane, before weights. Orders are added one after the other.
struct LaneSums {
    Lanes scattered = Lanes::Zero(), absorbed = Lanes::Zero(), asymmetric = Lanes::Zero();
};

/// The eight columns of a block that the eight spheres fill, or none.
template <typename Scalar>
struct BlockColumns {
    void put(int order, const ComplexLanes& a, const ComplexLanes& b) const;
    /// Rows that these eight do not reach, but others of the block do.
    void clear_beyond(int order) const;

    SphereBlockOf<Scalar>* block;  // null: nowhere
    int first;
    Lanes root_weight;
};

/// @param x  size parameters, ascending; from 2 on eight at once, below by mie_coefficients
template <typename Scalar>
LaneSums compute_eight(std::complex<double> m, const Lanes& x, const BlockColumns<Scalar>& to);

}  // namespace miebrdf::mie
