// Averages over spheroids of many sizes in random orientation.
#pragma once

#include <miebrdf/ensemble.h>

namespace miebrdf::mie {

/// All that a request may ask for, from the series of the scattering matrix: its degrees are few
/// enough that P at any angle is exact, and a phase table differs from it by interpolation alone.
///
/// Sizes are Gauss nodes in ln r, twice as many until extinction, albedo and all coefficients keep
/// within the tolerance; a T-matrix each (mie/spheroid). The estimate adds the change by the last
/// doubling and the largest estimate of a T-matrix, weighted by what each size scatters.
///
/// @param request  valid, with an aspect
MatrixOptics average_spheroids(const EnsembleRequest& request, const Executor& run);

/// The least time that this will take, in seconds of one thread (right to a factor of three).
double spheroid_seconds(const EnsembleRequest& request);

}  // namespace miebrdf::mie
