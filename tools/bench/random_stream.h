// Random numbers for photons.
#pragma once

#include <array>
#include <cstdint>

namespace miebrdf::bench {

/// Random numbers as a function of (seed, stream, position): the same for any order of evaluation.
using PhiloxCounter = std::array<std::uint32_t, 4>;
using PhiloxKey = std::array<std::uint32_t, 2>;

/// Philox4x32-10 (Salmon, Moraes, Dror & Shaw 2011, "Parallel random numbers: as easy as 1, 2, 3").
PhiloxCounter philox(PhiloxCounter counter, PhiloxKey key);

/// Uniform numbers of one stream, for instance of one photon.
class RandomStream {
  public:
    RandomStream(std::uint64_t seed, std::uint64_t stream);

    /// In (0, 1), both ends excluded: 53 random bits, shifted by half a unit, so that logarithms
    /// are finite.
    double uniform();

  private:
    PhiloxKey key_;
    PhiloxCounter counter_;
    PhiloxCounter block_ = {};
    int used_ = 4;
};

}  // namespace miebrdf::bench
