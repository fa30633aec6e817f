#include "pipeline/render/sampler.h"

#include <cstddef>

namespace miebrdf::render {
namespace {

/// Mixes all bits; constants of C. Wellons' search for low-bias 32-bit hashes.
std::uint32_t mix(std::uint32_t x) {
    x ^= x >> 16;
    x *= 0x7feb352dU;
    x ^= x >> 15;
    x *= 0x846ca68bU;
    x ^= x >> 16;
    return x;
}

std::uint32_t combine(std::uint32_t a, std::uint32_t b) { return mix(a ^ mix(b + 0x9e3779b9U)); }

std::uint32_t reverse_bits(std::uint32_t x) {
    x = (x << 16) | (x >> 16);
    x = ((x & 0x00ff00ffU) << 8) | ((x & 0xff00ff00U) >> 8);
    x = ((x & 0x0f0f0f0fU) << 4) | ((x & 0xf0f0f0f0U) >> 4);
    x = ((x & 0x33333333U) << 2) | ((x & 0xccccccccU) >> 2);
    return ((x & 0x55555555U) << 1) | ((x & 0xaaaaaaaaU) >> 1);
}

/// Owen's nested uniform scramble. Each bit is flipped by a hash of the bits above it: a hash
/// whose bits depend on lower bits only (Laine & Karras 2011, multipliers of Burley 2020), applied
/// to the reversed number.
std::uint32_t owen_scramble(std::uint32_t x, std::uint32_t seed) {
    x = reverse_bits(x);
    x += seed;
    x ^= x * 0x6c50b47cU;
    x ^= x * 0xb82f1e52U;
    x ^= x * 0xc7afe638U;
    x ^= x * 0x8d22f6e6U;
    return reverse_bits(x);
}

using SobolMatrix = std::array<std::uint32_t, 32>;

/// Columns of a Sobol dimension from its primitive polynomial and first odd numbers m (Joe & Kuo
/// 2008, table new-joe-kuo-6): v_k = m_k 2^(32-k), then the recurrence of Bratley & Fox (1988).
constexpr SobolMatrix sobol_matrix(unsigned degree, unsigned coefficients,
                                   std::array<std::uint32_t, 3> m) {
    SobolMatrix v{};
    for (unsigned k = 0; k < 32; ++k) {
        if (k < degree) {
            v[k] = m[k] << (31 - k);
            continue;
        }
        v[k] = v[k - degree] ^ (v[k - degree] >> degree);
        for (unsigned j = 1; j < degree; ++j) {
            if (((coefficients >> (degree - 1 - j)) & 1U) != 0) v[k] ^= v[k - j];
        }
    }
    return v;
}

/// Dimensions 2, 3 and 4; the first is the reversed index.
constexpr std::array<SobolMatrix, 3> kSobol = {
    sobol_matrix(1, 0, {1, 0, 0}), sobol_matrix(2, 1, {1, 3, 0}), sobol_matrix(3, 1, {1, 3, 1})};

/// Sums of the columns that belong to the bits of each byte of an index: a scrambled index has
/// all 32 bits, and a branch for each was a tenth of a picture's time.
using ByteSums = std::array<std::array<std::uint32_t, 256>, 4>;

constexpr ByteSums byte_sums(const SobolMatrix& columns) {
    ByteSums sums{};
    for (std::size_t byte = 0; byte < 4; ++byte) {
        for (std::size_t bits = 0; bits < 256; ++bits) {
            for (std::size_t bit = 0; bit < 8; ++bit) {
                if (((bits >> bit) & 1U) != 0) sums[byte][bits] ^= columns[8 * byte + bit];
            }
        }
    }
    return sums;
}

constexpr std::array<ByteSums, 3> kSums = {byte_sums(kSobol[0]), byte_sums(kSobol[1]),
                                           byte_sums(kSobol[2])};

std::uint32_t sobol(unsigned dimension, std::uint32_t index) {
    if (dimension == 0) return reverse_bits(index);
    const ByteSums& sums = kSums[dimension - 1];
    return sums[0][index & 0xffU] ^ sums[1][(index >> 8) & 0xffU] ^ sums[2][(index >> 16) & 0xffU] ^
           sums[3][index >> 24];
}

double to_unit(std::uint32_t x) { return x * 0x1p-32; }

}  // namespace

Sampler::Sampler(std::uint32_t x, std::uint32_t y, std::uint32_t seed, std::uint32_t sample)
    : pixel_(combine(combine(mix(x), y), seed)), sample_(sample) {}

std::array<double, 2> Sampler::next() {
    const std::uint32_t seed = combine(pixel_, pair_ / 2);
    const std::uint32_t index = owen_scramble(sample_, seed);
    const unsigned first = 2 * (pair_ % 2);
    ++pair_;
    return {to_unit(owen_scramble(sobol(first, index), combine(seed, first + 1))),
            to_unit(owen_scramble(sobol(first + 1, index), combine(seed, first + 2)))};
}

}  // namespace miebrdf::render
