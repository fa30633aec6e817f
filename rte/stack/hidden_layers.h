// Whether a coat hides the layers below it, as the solver, the choice of visible layers and the
// plan ask.
#pragma once

#include <vector>

#include <miebrdf/optics.h>
#include <miebrdf/solver.h>

namespace miebrdf::rte {

struct FourierMedium;
struct ScaledMedium;
struct ScaledStack;

/// False where exp(-tau (1/mu_in + 1/mu_out)), light that goes straight through the coat and back,
/// is more than the tolerance of hidden layers: such a coat hides nothing, whatever its optics.
/// @param directions  may be without mu_out: only albedos are wanted
bool may_hide(double optical_depth, const Directions& directions, double tolerance);

/// Whether nothing below a coat shows within its share of the tolerance (kHiddenLayersShare).
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

/// A lower bound of the largest R at each incidence, to which errors are relative: light scattered
/// once, the largest value over (some of) the directions at the incidence where it is least.
/// @param media  from the bottom up
double least_brightness(const std::vector<ScaledMedium>& media, const Directions& directions);

/// The same inside the boundary of a stack: the light of hidden layers leaves through the same
/// surface, so that their ratio stays.
double least_brightness(const ScaledStack& stack, const Directions& directions);

/// Whether a coat counts as a half-space in one Fourier order, by a bound that costs nothing.
/// @param allowed  change of R by the layers below, absolute
bool hides_in_fourier_order(const FourierMedium& coat, double scaled_optical_depth, double allowed);

/// Whether the depth is infinite: the coat is a half-space, and the solver ignores layers below.
bool is_bottomless(double optical_depth);

/// A finite scaled optical depth of at most 5e102, of which squares do not overflow (no layer below
/// shows in double precision, even where nothing absorbs); infinity stays infinity.
double bounded_depth(double scaled_optical_depth);

/// The stack with a black ground in place of media of albedo 0 at its bottom.
Stack with_black_ground(Stack stack);

}  // namespace miebrdf::rte
