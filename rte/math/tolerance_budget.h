// How the tolerance of a result is shared between the steps that lead to it, and when a result has
// converged.
#pragma once

namespace miebrdf {

// Each share is a fraction of the tolerance of the whole result, which is relative to the largest
// value at an incidence. What is left, most of it, is for the number of streams: that error is
// estimated by comparing two numbers of nodes, and it is the only one that costs much to reduce.

/// Less than this share of the tolerance is never stated: differences that are smaller are so by
/// chance.
inline constexpr double kLeastStatedShare = 0.1;

/// The error that transfer may make in any case, even where a tolerance of the size average that
/// was asked for leaves it less.
inline constexpr double kLeastTransferShare = 0.5;
/// Averages over sphere sizes, unless a tolerance of their own is given.
inline constexpr double kMieShare = 0.2;
/// A step that is taken once leaves nearly all of the tolerance to the nodes; so does one that is
/// taken for each Fourier order, degree or piece, whose errors add up.
inline constexpr double kShareOfOneStep = 0.1, kShareOfEachOrder = 0.01;
/// Fourier orders that are left out at the end of the sum.
inline constexpr double kFourierTailShare = 0.25;
/// Fourier orders of a solution with fewer nodes are taken over once they agree to this.
inline constexpr double kCoarserOrdersShare = kShareOfEachOrder;
/// The equations of one Fourier order: iterated half-spaces, refined eigenmodes, and what lies
/// below a coat that counts as a half-space in that order.
inline constexpr double kEquationShare = kShareOfEachOrder;
/// Orders above 0 of a half-space may err by this share of what order 0 may: that is brightest
/// where it is, and errors count relative to the largest value at each incidence.
inline constexpr double kHigherOrderShare = 0.1;
/// Iterations inside the equations of one order end when this share of what these may err by is
/// left.
inline constexpr double kIterationShare = 0.1;
/// Legendre degrees with (2l + 1) chi_l below this are dropped where light scattered once lacks
/// them too: the sum of all that are dropped shows.
inline constexpr double kDroppedMomentShare = kShareOfEachOrder;
/// Layers below a coat that hides them (rte/stack/hidden_layers.h).
inline constexpr double kHiddenLayersShare = kShareOfOneStep;
/// Narrow features of the first order: interpolation and the terms left out.
inline constexpr double kGloryShare = kShareOfOneStep;
/// Tables of exact phase functions against the angle, relative to the largest coefficient of a
/// piece: so small that steps between the pieces stay below whatever is made of the values
/// (azimuthal series, for instance).
inline constexpr double kPhaseTableShare = kShareOfEachOrder;

// Phase functions from Mie theory are noisy at single angles: a finite number of sphere sizes does
// not average out every ripple, and single angles count for little in a reflection.

/// Points of P may err by this times what the moments may (1e-2 at a tolerance of 1e-3), within the
/// two limits.
inline constexpr double kPhasePerMoment = 50.0;
inline constexpr double kLeastPhaseTolerance = 2e-4;
inline constexpr double kMostPhaseTolerance = 3e-2;
/// The error that P may cause in single directions, as an error estimate.
inline constexpr double kPhaseShare = 0.4;
/// Points that are computed anew get this part of what all other estimates have left of the
/// tolerance, and no less than half of that where the forward peak brings a doubt of its own: they
/// err by twice an rms, and of many values that may all err by so much some are beyond it. With
/// all of it 3 of 118 converged scenes erred by more than the tolerance, with 0.85 2 of 119
/// (docs/internals/mie-log.md#errors-value-by-value).
inline constexpr double kShareOfPoints = 0.85;
inline constexpr double kLeastBesideDoubt = 0.5;
/// The least that is asked of P at listed angles.
inline constexpr double kLeastAngleTolerance = 1e-6;
/// The part of the error of points of P that interpolation between them may have.
inline constexpr double kPhaseInterpolationShare = 0.5;

/// Albedos and transmittances are relative to themselves, but to no less than this share of the
/// incident flux: an optical density of 6 has its digits, what is darker needs none.
inline constexpr double kLeastJudgedFlux = 1e-6;

/// The one decision of what has converged: the estimate is within the tolerance, and every step on
/// the way has converged itself. An estimate of NaN has not.
template <typename... Steps>
constexpr bool has_converged(double error_estimate, double tolerance, Steps... steps) {
    return (... && steps) && error_estimate <= tolerance;
}

}  // namespace miebrdf
