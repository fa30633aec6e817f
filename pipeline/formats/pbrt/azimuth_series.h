// Cosine series in azimuth of a BRDF at given pairs of cosines.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include <miebrdf/brdf_source.h>

namespace miebrdf {

struct CosinePair {
    double mu_in = 1.0;
    double mu_out = 1.0;
};

/// f(channel, azimuth) = sum_k a_k cos(k azimuth) of one pair, azimuth 0 = mirror side.
struct AzimuthSeries {
    std::size_t channels = 0;
    std::vector<double> coefficients;  ///< [channel * orders + k]
    double tail = 0.0;  ///< largest |a_k| of the last eighth of orders, relative to its a_0

    std::size_t orders() const { return coefficients.size() / channels; }
    std::span<const double> of(std::size_t channel) const {
        return std::span(coefficients).subspan(channel * orders(), orders());
    }
};

/// The series through equally spaced samples of half a turn (a DCT of the first kind, exact for
/// series shorter than the number of samples). For each pair the number of orders is doubled from
/// 64 (so that nothing wider than some degrees hides between samples) until the tail is below
/// `tail_tolerance` or `most_orders` is reached: then `tail` says what is missing, and the series
/// is tapered: its peaks are as wide as its orders can show them, with nothing ringing around them.
///
/// @param most_orders  16 to 4096
/// @param take         gets each pair's series, in any order and from several threads
/// @throws UsageError  most_orders out of range; Cancelled
void azimuth_series(const BrdfSource& source, std::span<const CosinePair> pairs,
                    double tail_tolerance, int most_orders, const Control& control,
                    const std::function<void(std::size_t pair, const AzimuthSeries&)>& take);

}  // namespace miebrdf
