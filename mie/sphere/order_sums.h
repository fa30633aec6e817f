// The sums over partial waves that the efficiencies of one large sphere are made of.
#pragma once

#include <complex>

namespace miebrdf::mie {

/// Sums over the orders of one sphere.
struct OrderSums {
    double scattered = 0;           ///< x^2 Q_sca / 2
    double absorbed = 0;            ///< x^2 Q_abs / 2
    double asymmetric = 0;          ///< x^2 g Q_sca / 4
    std::complex<double> back = 0;  ///< sum (2n+1) (-1)^n (a_n - b_n)
};

/// Eight segments of the orders at once, one in each lane of a vector: nothing is stored but the
/// waves at the ends of the segments and outside beyond n = x.
///
/// Where the waves are at the ends follows from a first pass over all segments, with the two
/// solutions of the recurrence that are (1, 0) and (0, 1) at one end of each. The second pass goes
/// downward, which no wave inside objects to, and forms a_n and b_n on its way.
///
/// @param m  double or std::complex<double>; |m - 1| well above rounding
/// @param x  size parameter, at least kLeastSegmentedSize
template <typename Number>
OrderSums sum_orders_by_segments(Number m, double x);

/// Smaller spheres have too few orders for segments.
constexpr double kLeastSegmentedSize = 64;

}  // namespace miebrdf::mie
