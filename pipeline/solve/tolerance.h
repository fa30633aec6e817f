// How `--tolerance` is shared between the steps of a computation; all relative to the largest value
// at an incidence. What is left, most of it, is for the streams: their error is the one estimated
// by comparing two numbers of nodes, and the only one that costs much to reduce.
#pragma once

#include "rte/stack/fourier_sum.h"

namespace miebrdf {

struct ToleranceShares {
    double mie = 0.2;  ///< of the size average, unless --mie-tolerance says otherwise
    double orders = rte::share_of_orders;  ///< azimuthal orders left out
    double iteration = 0.01;     ///< of an iterative half-space, so that coats of one base share it
    double hidden_layers = 0.1;  ///< what lies below a coat that hides it (visible_layers.h)
};

inline constexpr ToleranceShares kToleranceShares;

}  // namespace miebrdf
