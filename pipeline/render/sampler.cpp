#include "pipeline/render/sampler.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

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

namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kLobeShare = 0.5;

}  // namespace

BounceSampler::BounceSampler(const Eigen::Vector3d& normal, const Eigen::Vector3d& towards_viewer,
                             double lobe_alpha)
    : normal_(normal),
      viewer_(towards_viewer),
      alpha_(lobe_alpha),
      lobe_share_(lobe_alpha > 0.0 ? kLobeShare : 0.0) {
    // The axis least aligned with the normal gives a well-conditioned tangent.
    Eigen::Index axis = 0;
    normal.cwiseAbs().minCoeff(&axis);
    tangent_ = Eigen::Vector3d::Unit(axis).cross(normal).normalized();
    bitangent_ = normal.cross(tangent_);
}

Eigen::Vector3d BounceSampler::to_world(double cos_polar, double azimuth) const {
    const double sin_polar = std::sqrt(std::max(0.0, (1 - cos_polar) * (1 + cos_polar)));
    return (sin_polar * std::cos(azimuth) * tangent_ + sin_polar * std::sin(azimuth) * bitangent_ +
            cos_polar * normal_)
        .normalized();
}

Eigen::Vector3d BounceSampler::sample(std::array<double, 2> u) const {
    const double azimuth = 2 * kPi * u[1];
    // The first number chooses the way; what remains of it is as evenly spread as it was.
    if (u[0] >= lobe_share_) {
        return to_world(std::sqrt((1 - u[0]) / (1 - lobe_share_)), azimuth);
    }
    const double tan2 = -alpha_ * alpha_ * std::log1p(-u[0] / lobe_share_);
    const Eigen::Vector3d half = to_world(1 / std::sqrt(1 + tan2), azimuth);
    return (2 * viewer_.dot(half) * half - viewer_).normalized();
}

double BounceSampler::density(const Eigen::Vector3d& direction) const {
    const double cosine = std::max(0.0, direction.dot(normal_));
    double density = (1 - lobe_share_) * cosine / kPi;
    if (lobe_share_ > 0.0) {
        const Eigen::Vector3d half = (direction + viewer_).normalized();
        const double cos_normal = half.dot(normal_), cos_light = half.dot(viewer_);
        if (cos_normal > 0.0 && cos_light > 0.0) {
            density +=
                lobe_share_ * beckmann_density(cos_normal, alpha_) * cos_normal / (4 * cos_light);
        }
    }
    return density;
}

HalfVector half_vector(double mu_in, double mu_out, double cos_azimuth) {
    const double sin_in = std::sqrt(std::max(0.0, (1.0 - mu_in) * (1.0 + mu_in)));
    const double sin_out = std::sqrt(std::max(0.0, (1.0 - mu_out) * (1.0 + mu_out)));
    const double cos_between = mu_in * mu_out - sin_in * sin_out * cos_azimuth;
    const double cos_light = std::sqrt(std::max(0.0, 0.5 * (1.0 + cos_between)));
    // |light + view| = 2 cos_light; never 0 for two directions above the horizon.
    return {std::min(1.0, (mu_in + mu_out) / (2.0 * cos_light)), cos_light};
}

double beckmann_density(double cos_normal, double alpha) {
    const double cos2 = cos_normal * cos_normal;
    const double tan2 = (1.0 - cos_normal) * (1.0 + cos_normal) / cos2;
    const double alpha2 = alpha * alpha;
    return std::exp(-tan2 / alpha2) / (std::numbers::pi * alpha2 * cos2 * cos2);
}

}  // namespace miebrdf::render
