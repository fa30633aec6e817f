// Moments of broad size distributions without their ripple: rays of the Debye series, averaged
// without the phases between them.
#pragma once

#include <complex>

#include "mie/ensemble/moment_transform.h"
#include "mie/ensemble/size_sums.h"

namespace miebrdf::mie {

/// Sums over sizes as SphereSums, and what MomentTransform makes moments of.
struct RaySums {
    double extinguished = 0;  ///< sum w_s sum_n (2n+1) Re(a_n + b_n)
    double absorbed = 0;      ///< summed from what each way through the sphere loses; 0 for real m
    MomentTransform::Collected collected;  ///< in single precision: 1e-7 of the sums
};

/// Partial waves split into rays of p ways through the sphere (RayWaves), whose phases a broad
/// distribution spreads over many turns: products of different p average out, and
///     <a_n a_m*> = 1/4 <(1 - R22_n)(1 - R22_m)* + T_n T_m* / (1 - R11_n R11_m*)>.
/// Summed over n this is smooth in size: 16 Gauss sizes in ln r give what thousands of spheres do.
/// The terms linear in R22 (diffracted and reflected light) turn with size too, but for the edge,
/// n > x - 8 x^(1/3): they are faded out below. What is left below is also smooth in n and summed
/// by Gauss rules over the integers.
RaySums sum_over_rays(std::complex<double> relative_index, const WeightedSizes& sizes,
                      const MomentTransform& transform, const Executor& run);

}  // namespace miebrdf::mie
