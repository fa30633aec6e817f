#include "tools/bench/random_stream.h"

namespace miebrdf::bench {
namespace {

// Constants of Salmon et al. 2011, table 2 and section 4.3.
constexpr std::uint64_t kMultiplier0 = 0xD2511F53;
constexpr std::uint64_t kMultiplier1 = 0xCD9E8D57;
constexpr std::uint32_t kWeyl0 = 0x9E3779B9;
constexpr std::uint32_t kWeyl1 = 0xBB67AE85;
constexpr int kRounds = 10;

std::uint32_t low(std::uint64_t x) { return static_cast<std::uint32_t>(x); }
std::uint32_t high(std::uint64_t x) { return static_cast<std::uint32_t>(x >> 32); }

}  // namespace

PhiloxCounter philox(PhiloxCounter c, PhiloxKey k) {
    for (int round = 0; round < kRounds; ++round) {
        const std::uint64_t a = kMultiplier0 * c[0];
        const std::uint64_t b = kMultiplier1 * c[2];
        c = {high(b) ^ c[1] ^ k[0], low(b), high(a) ^ c[3] ^ k[1], low(a)};
        k = {k[0] + kWeyl0, k[1] + kWeyl1};
    }
    return c;
}

RandomStream::RandomStream(std::uint64_t seed, std::uint64_t stream)
    : key_{low(seed), high(seed)}, counter_{0, 0, low(stream), high(stream)} {}

double RandomStream::uniform() {
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

}  // namespace miebrdf::bench
