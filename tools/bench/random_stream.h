// Random numbers for photons.
#pragma once

#include <array>
#include <cstdint>

namespace miebrdf::bench {

using PhiloxCounter = std::array<std::uint32_t, 4>;
using PhiloxKey = std::array<std::uint32_t, 2>;

/// Philox4x32-10 (Salmon, Moraes, Dror & Shaw 2011, "Parallel random numbers: as easy as 1, 2, 3";
/// constants of its table 2 and section 4.3): random numbers as a function of seed, stream and
/// position, the same for any order of evaluation.
inline PhiloxCounter philox(PhiloxCounter c, PhiloxKey k) {
    const auto low = [](std::uint64_t x) { return static_cast<std::uint32_t>(x); };
    const auto high = [](std::uint64_t x) { return static_cast<std::uint32_t>(x >> 32); };
    for (int round = 0; round < 10; ++round) {
        const std::uint64_t a = std::uint64_t{0xD2511F53} * c[0];
        const std::uint64_t b = std::uint64_t{0xCD9E8D57} * c[2];
        c = {high(b) ^ c[1] ^ k[0], low(b), high(a) ^ c[3] ^ k[1], low(a)};
        k = {k[0] + 0x9E3779B9, k[1] + 0xBB67AE85};
    }
    return c;
}

/// Uniform numbers of one stream, for instance of one photon.
class RandomStream {
  public:
    RandomStream(std::uint64_t seed, std::uint64_t stream)
        : key_{std::uint32_t(seed), std::uint32_t(seed >> 32)},
          counter_{0, 0, std::uint32_t(stream), std::uint32_t(stream >> 32)} {}

    /// In (0, 1), both ends excluded: 53 random bits, shifted by half a unit, so that logarithms
    /// are finite.
    double uniform() {
        if (used_ == 4) {
            block_ = philox(counter_, key_);
            if (++counter_[0] == 0) ++counter_[1];
            used_ = 0;
        }
        const std::uint64_t bits = (std::uint64_t{block_[used_]} << 32 | block_[used_ + 1]) >> 11;
        used_ += 2;
        // The largest sum would round up to 1 in the last place.
        const double u = (static_cast<double>(bits) + 0.5) * 0x1p-53;
        return u < 1.0 ? u : 1.0 - 0x1p-53;
    }

  private:
    PhiloxKey key_;
    PhiloxCounter counter_, block_ = {};
    std::size_t used_ = 4;
};

}  // namespace miebrdf::bench
