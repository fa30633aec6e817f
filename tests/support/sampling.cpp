#include "tests/support/sampling.h"

#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <cmath>
#include <numbers>
#include <random>

namespace miebrdf::support {
namespace {

using exports::BrdfFile;
using exports::Direction;

double uniform(std::mt19937_64& engine) {
    return (static_cast<double>(engine() >> 12) + 0.5) * 0x1p-52;
}

/// The direction with the drawn cosine where this file's sampling puts it.
Direction drawn(const BrdfFile& file, double mu_fixed, double mu, double azimuth_deg) {
    return file.sampling() == BrdfFile::Sampling::from_mu_in ? Direction{mu_fixed, mu, azimuth_deg}
                                                             : Direction{mu, mu_fixed, azimuth_deg};
}

double drawn_mu(const BrdfFile& file, const Direction& direction) {
    return file.sampling() == BrdfFile::Sampling::from_mu_in ? direction.mu_out : direction.mu_in;
}

}  // namespace

std::vector<double> sampled_albedo(const BrdfFile& file, double mu_fixed, int samples) {
    // A lattice of uniform numbers, turned by a random shift, has less noise than random ones.
    const int side = std::max(1, int(std::sqrt(samples)));
    std::vector<double> sums(file.channels().size(), 0.0), values(sums.size());
    for (int i = 0; i < side; ++i) {
        for (int j = 0; j < side; ++j) {
            const auto direction = file.sample(mu_fixed, (i + 0.37) / side, (j + 0.61) / side);
            if (!direction) continue;
            const double density = file.density(*direction);
            if (!(density > 0)) continue;
            file.evaluate(*direction, values);
            const double weight = drawn_mu(file, *direction) / density / side / side;
            for (std::size_t c = 0; c < sums.size(); ++c) sums[c] += values[c] * weight;
        }
    }
    return sums;
}

double chi_square_probability(const BrdfFile& file, double mu_fixed, int samples) {
    constexpr int kCosines = 10, kAzimuths = 12, kInner = 24;
    std::vector<double> counts(kCosines * kAzimuths, 0.0), expected(kCosines * kAzimuths, 0.0);
    std::mt19937_64 engine(11);
    int drawn_samples = 0;
    for (int i = 0; i < samples; ++i) {
        const double u = uniform(engine), v = uniform(engine);
        const auto direction = file.sample(mu_fixed, u, v);
        if (!direction) continue;
        ++drawn_samples;
        const double azimuth = std::abs(std::remainder(direction->azimuth_deg, 360.0));
        const int row = std::min(kCosines - 1, int(drawn_mu(file, *direction) * kCosines));
        const int column = std::min(kAzimuths - 1, int(azimuth / 180 * kAzimuths));
        counts[row * kAzimuths + column] += 1;
    }
    double total = 0.0;
    for (int row = 0; row < kCosines * kInner; ++row) {
        for (int column = 0; column < kAzimuths * kInner; ++column) {
            const double mu = (row + 0.5) / (kCosines * kInner);
            const double azimuth = 180 * (column + 0.5) / (kAzimuths * kInner);
            const double density = file.density(drawn(file, mu_fixed, mu, azimuth));
            expected[row / kInner * kAzimuths + column / kInner] += density;
            total += density;
        }
    }
    double chi_square = 0.0, pooled_count = 0.0, pooled_expected = 0.0;
    int bins = 0;
    for (std::size_t i = 0; i < counts.size(); ++i) {
        pooled_count += counts[i];
        pooled_expected += expected[i] / total * drawn_samples;
        if (pooled_expected < 5) continue;
        chi_square += std::pow(pooled_count - pooled_expected, 2) / pooled_expected;
        pooled_count = pooled_expected = 0.0;
        ++bins;
    }
    return boost::math::cdf(
        boost::math::complement(boost::math::chi_squared(bins - 1), chi_square));
}

std::vector<double> integrated_albedo(const exports::BrdfSource& source, double mu_in) {
    constexpr int kCosines = 200, kAzimuths = 200;
    const std::size_t channels = source.channels().size();
    std::vector<double> sums(channels, 0.0), values(channels);
    for (int i = 0; i < kCosines; ++i) {
        const double mu = (i + 0.5) / kCosines;
        for (int j = 0; j < kAzimuths; ++j) {
            const Direction direction{mu_in, mu, 180.0 * (j + 0.5) / kAzimuths};
            source.evaluate({&direction, 1}, values);
            for (std::size_t c = 0; c < channels; ++c) {
                sums[c] += values[c] * mu * 2 * std::numbers::pi / kCosines / kAzimuths;
            }
        }
    }
    return sums;
}

}  // namespace miebrdf::support
