// Waves inside spheres of layers, for eight sizes at once.
#pragma once

#include <array>
#include <span>
#include <vector>

#include <miebrdf/sphere.h>
#include "mie/sphere/lane_math.h"

namespace miebrdf::mie {

/// A layer of eight spheres: its index and the size parameters at its outer surfaces.
struct LaneLayer {
    std::complex<double> relative_index;
    Lanes size_parameter;
};

/// Logarithmic derivatives of the waves inside, at the outer surfaces, n = 0 ... terms: of those
/// that a_n hangs on, and of those of b_n. Of a homogeneous sphere both are D_n(mx).
struct LayeredInside {
    std::vector<ComplexLanes> electric, magnetic;
};

/// From the core outwards: the tangential fields are continuous, so that D_n / m of a_n and m D_n
/// of b_n are the same on both sides of a surface (Yang 2003, Appl. Opt. 42, 1710).
///
/// @param layers  from the core outwards, size parameters not falling from one to the next; shells
///                without thickness in any lane are left out
/// @return  valid until the thread calls this again
const LayeredInside& layered_inside(std::span<const LaneLayer> layers, int terms);

/// mie_coefficients of eight spheres of layers, one in each lane.
std::array<Coefficients, kLaneCount> layered_coefficients(std::span<const LaneLayer> layers);

}  // namespace miebrdf::mie
