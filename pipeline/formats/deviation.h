// How far a file, read as its program reads it, is from the BRDF that it was made from.
#pragma once

#include <array>
#include <cstdint>

#include "pipeline/formats/readers/brdf_file.h"

namespace miebrdf::exports {

/// Root mean square of relative errors over random directions, by m = min(mu_in, mu_out). Values
/// below a hundredth of the mean (tails of a lobe) are compared with that.
struct Deviation {
    /// m > 0.2, 0.05 < m <= 0.2, m <= 0.05 (down to 0.005: below, 17 arc minutes above the horizon,
    /// relative errors of formats that store BRDF times cosine have no bound).
    std::array<double, 3> rms = {0.0, 0.0, 0.0};
    /// Error of the values near the mirror direction (lobe_directions), rms over rms: what a file
    /// makes of a surface lobe that random directions hardly ever meet.
    double lobe = 0.0;
    double largest = 0.0;        ///< of all directions, relative to the BRDF's mean over directions
    std::size_t directions = 0;  ///< compared; those where the file has no value are left out
    std::size_t missing = 0;
};

inline constexpr std::array<const char*, 3> kDeviationBands = {"mu > 0.2", "mu 0.05-0.2",
                                                               "mu < 0.05"};

/// Cosines and azimuth uniform, each band filled; the same numbers on every machine for a seed.
std::vector<Direction> random_directions(std::size_t count, std::uint64_t seed);

/// Both cosines above 0.4; the half vector is off the normal by 0.001 to 0.5 rad, evenly in its
/// logarithm, so that lobes of any width are met.
std::vector<Direction> lobe_directions(std::size_t count, std::uint64_t seed);

/// Compares channel by channel. @param source  with as many channels as the file
/// @throws UsageError  when their numbers differ
Deviation measure_deviation(const BrdfFile& file, const BrdfSource& source,
                            std::span<const Direction> directions);

}  // namespace miebrdf::exports
