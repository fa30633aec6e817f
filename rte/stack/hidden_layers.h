// Whether a coat hides the layers below it: asked by the solver, the choice of visible layers and
// the plan.
#pragma once

#include <vector>

#include <miebrdf/optics.h>
#include <miebrdf/solver.h>

namespace miebrdf::rte {

struct FourierMedium;
struct ScaledMedium;
struct ScaledStack;

/// False where the light that goes straight through the coat and back, exp(-tau (1/mu_in +
/// 1/mu_out)), exceeds the tolerance of hidden layers: such a coat hides nothing, whatever its
/// optics.
/// @param directions  may be without mu_out: only albedos are wanted
bool may_hide(double optical_depth, const Directions& directions, double tolerance);

/// Whether the layers below a coat change R by less than kHiddenLayersShare of the tolerance.
///
/// With u = 1 - alpha and v = 1 - alpha max |chi_l| over odd l, the matrices U and V (eigenmodes.h)
/// are at least u M^-1 and v M^-1, so that all modes decay at least like exp(-k tau), k^2 = u v.
/// Between a black and a white base R then changes by about 2 (k / v) / sinh(2 k tau) at most;
/// another base may be up to 100 times brighter in one direction. The coat hides the base where 100
/// times this change is within the tolerance of R, relative to light scattered once by the coat
/// itself (the incidence where that is darkest).
/// @param directions  without mu_out: only albedos are wanted
bool hides_what_is_below(const Optics& coat, double optical_depth, const Directions& directions,
                         double tolerance);

/// A lower bound of the scale of errors, the largest R at an incidence: the largest R of light
/// scattered once over (some of) the outgoing directions, at the incidence where that is least.
/// @param media  from the bottom up
double least_brightness(const std::vector<ScaledMedium>& media, const Directions& directions);

/// The same with directions below the boundary of the stack. Light of hidden layers leaves through
/// the same boundary, which does not change the ratio.
double least_brightness(const ScaledStack& stack, const Directions& directions);

/// Whether the layers below a coat change R^m by less than `allowed` (absolute), by a bound that
/// needs no solution: the coat is then solved as a half-space.
bool hides_in_fourier_order(const FourierMedium& coat, double scaled_optical_depth, double allowed);

/// Whether the depth is infinite: the coat is a half-space, and the solver ignores layers below.
bool is_bottomless(double optical_depth);

/// min(depth, 5e102), of which squares do not overflow and which hides everything below in double
/// precision, even without absorption. Infinity stays infinity.
double bounded_depth(double scaled_optical_depth);

/// The stack with a black ground in place of media of albedo 0 at its bottom.
Stack with_black_ground(Stack stack);

}  // namespace miebrdf::rte
