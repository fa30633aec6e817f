// Integrals of one decaying exponential against another over a layer, without cancellation.
#pragma once

namespace miebrdf::math {

struct DecayIntegrals {
    double near;  ///< x int_0^1 exp(-x u) sinh(y (1 - u)) / sinh(y) du
    double far;   ///< x int_0^1 exp(-x u) sinh(y u) / sinh(y) du
};

/// Both for x = tau / mu >= 0 and y = k tau >= 0; y = 0 is the limit sinh(y u) / sinh(y) = u.
/// Relative error a few units in the last place everywhere, x = y included: three forms of the same
/// integrals, each used where nothing cancels.
DecayIntegrals decay_integrals(double x, double y);

}  // namespace miebrdf::math
