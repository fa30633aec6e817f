// Cosine series in azimuth of a BRDF at given pairs of cosines.
#pragma once

#include <span>
#include <vector>

#include "pipeline/exports/brdf_source.h"

namespace miebrdf::exports {

struct CosinePair {
    double mu_in = 1.0;
    double mu_out = 1.0;
};

/// f(pair, channel, azimuth) = sum_k a_k cos(k azimuth), azimuth 0 = mirror side.
struct AzimuthSeries {
    int orders = 0;  ///< k = 0 ... orders - 1
    std::size_t channels = 0;
    std::vector<double> coefficients;  ///< [(pair * channels + channel) * orders + k]
    double tail = 0.0;  ///< largest |a_k| of the last eighth of orders, relative to its a_0

    std::span<const double> of(std::size_t pair, std::size_t channel) const {
        const auto count = static_cast<std::size_t>(orders);
        return std::span(coefficients).subspan((pair * channels + channel) * count, count);
    }
};

/// The series through equally spaced samples of half a turn (a DCT of the first kind, exact for
/// series shorter than the number of samples). The number of orders is doubled from 16 until the
/// tail is below `tail_tolerance` or `most_orders` is reached: then `tail` says what is missing.
///
/// @param most_orders  16 to 4096
/// @throws UsageError  most_orders out of range; Cancelled
AzimuthSeries azimuth_series(const BrdfSource& source, std::span<const CosinePair> pairs,
                             double tail_tolerance, int most_orders, const RunControl& control);

}  // namespace miebrdf::exports
