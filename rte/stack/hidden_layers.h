// Whether a coat hides what lies below it: all questions about it that the solver, the choice of
// visible layers and the plan ask.
#pragma once

#include <vector>

#include <miebrdf/optics.h>
#include <miebrdf/solver.h>

namespace miebrdf::rte {

struct FourierMedium;
struct ScaledMedium;
struct ScaledStack;

/// Whether light that went straight through a coat and back is below the tolerance. A coat that
/// lets more through hides nothing, and no optics are needed to know it.
/// @param directions  may be without mu_out: only albedos are wanted
bool may_hide(double optical_depth, const Directions& directions, double tolerance);

/// Whether nothing below a coat shows within its share of the tolerance (kHiddenLayersShare).
///
/// With u = 1 - alpha and v = 1 - alpha max |chi_l| over odd l, U and V (eigenmodes.h) are at least
/// u M^-1 and v M^-1, so that nothing decays more slowly than exp(-k tau), k^2 = u v. Between a
/// black and a white base R changes by no more than about 2 (k / v) / sinh(2 k tau); other bases
/// may be brighter at single directions by the factor of safety (100). This is compared with the
/// least of what the coat itself scatters once at the incidences asked for: however dark a coat is,
/// it hides only what is darker.
/// @param directions  without mu_out: only albedos are wanted
bool hides_what_is_below(const Optics& coat, double optical_depth, const Directions& directions,
                         double tolerance);

/// A lower bound of the largest reflection at every incidence: light scattered once, at some of the
/// directions. Shares of the tolerance are relative to that.
/// @param media  from the bottom up
double least_brightness(const std::vector<ScaledMedium>& media, const Directions& directions);

/// The bound inside a stack below a boundary: what is scattered once and what hidden layers would
/// add to it leave through the same surface.
double least_brightness(const ScaledStack& stack, const Directions& directions);

/// Whether a coat counts as a half-space in one Fourier order: a bound, asked by the solver of
/// every coat and order.
/// @param allowed  of the reflection function, absolute
bool hides_in_fourier_order(const FourierMedium& coat, double scaled_optical_depth, double allowed);

/// A coat without bottom is a half-space: nothing below it exists for the solver.
bool is_bottomless(double optical_depth);

/// A scaled optical depth that the equations can bear. What lies below a coat of depth 1e100 does
/// not show in double precision, absorbing or not, and the square of the depth does not overflow;
/// infinity stays infinity.
double bounded_depth(double scaled_optical_depth);

/// Media of albedo 0 at the bottom of a stack return nothing: a black ground takes their place.
Stack with_black_ground(Stack stack);

}  // namespace miebrdf::rte
