#include "tests/support/sampling.h"

#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <cmath>
#include <numbers>
#include <random>

namespace miebrdf::support {
namespace {

double uniform(std::mt19937_64& engine) {
    return (static_cast<double>(engine() >> 12) + 0.5) * 0x1p-52;
}

double degrees(double radians) { return radians * 180 / std::numbers::pi; }

/// With the fixed vector at azimuth 0, the drawn one at azimuth a is a - 180 degrees off the mirror
/// side.
Direction direction_to(const BrdfFile& file, double mu_fixed, const Vector& drawn) {
    const double azimuth = 180 - degrees(std::atan2(drawn.y(), drawn.x()));
    return file.sampling() == BrdfFile::Sampling::from_mu_in
               ? Direction{mu_fixed, drawn.z(), azimuth}
               : Direction{drawn.z(), mu_fixed, azimuth};
}

}  // namespace

Vector to_light(const Direction& direction) {
    return {std::sqrt((1 - direction.mu_in) * (1 + direction.mu_in)), 0.0, direction.mu_in};
}

Vector to_viewer(const Direction& direction) {
    const double sine = std::sqrt((1 - direction.mu_out) * (1 + direction.mu_out));
    const double azimuth = direction.azimuth_deg * std::numbers::pi / 180;
    return {-sine * std::cos(azimuth), sine * std::sin(azimuth), direction.mu_out};
}

Sampling sampling_of(const OutsideFile& file, double mu_fixed) {
    const Vector fixed = to_light({mu_fixed, 1.0, 0.0});
    return {[=, &file](double u, double v) { return file.sample(fixed, u, v); },
            [=, &file](const Vector& drawn) { return file.density(fixed, drawn); },
            [=, &file](const Vector& drawn) {
                return file.starts_from_light() ? file.brdf(fixed, drawn) : file.brdf(drawn, fixed);
            }};
}

Sampling sampling_of(const BrdfFile& file, double mu_fixed) {
    return {[=, &file](double u, double v) -> std::optional<Vector> {
                const auto d = file.sample(mu_fixed, u, v);
                if (!d) return {};
                const bool from_in = file.sampling() == BrdfFile::Sampling::from_mu_in;
                return to_viewer({mu_fixed, from_in ? d->mu_out : d->mu_in, d->azimuth_deg});
            },
            [=, &file](const Vector& drawn) {
                return file.density(direction_to(file, mu_fixed, drawn));
            },
            [=, &file](const Vector& drawn) {
                std::vector<double> values(file.channels().size());
                file.evaluate(direction_to(file, mu_fixed, drawn), values);
                return values;
            }};
}

std::vector<double> sampled_albedo(const Sampling& sampling, int samples) {
    // A lattice of uniform numbers, turned by a random shift, has less noise than random ones.
    const int side = std::max(1, int(std::sqrt(samples)));
    std::vector<double> sums;
    for (int i = 0; i < side; ++i) {
        for (int j = 0; j < side; ++j) {
            const auto drawn = sampling.draw((i + 0.37) / side, (j + 0.61) / side);
            if (!drawn) continue;
            const double density = sampling.density(*drawn);
            if (!(density > 0)) continue;
            const std::vector<double> values = sampling.brdf(*drawn);
            sums.resize(values.size(), 0.0);
            for (std::size_t c = 0; c < sums.size(); ++c)
                sums[c] += values[c] * drawn->z() / density / side / side;
        }
    }
    return sums;
}

double chi_square_probability(const Sampling& sampling, int samples) {
    constexpr int kCosines = 10, kAzimuths = 12, kInner = 24;
    std::vector<double> counts(kCosines * kAzimuths, 0.0), expected(kCosines * kAzimuths, 0.0);
    std::mt19937_64 engine(11);
    int drawn_samples = 0;
    for (int i = 0; i < samples; ++i) {
        const double u = uniform(engine), v = uniform(engine);
        const auto drawn = sampling.draw(u, v);
        if (!drawn) continue;
        ++drawn_samples;
        const double azimuth = std::abs(degrees(std::atan2(drawn->y(), drawn->x())));
        const int row = std::min(kCosines - 1, int(drawn->z() * kCosines));
        const int column = std::min(kAzimuths - 1, int(azimuth / 180 * kAzimuths));
        counts[row * kAzimuths + column] += 1;
    }
    double total = 0.0;
    for (int row = 0; row < kCosines * kInner; ++row) {
        for (int column = 0; column < kAzimuths * kInner; ++column) {
            const double mu = (row + 0.5) / (kCosines * kInner);
            const double azimuth = 180 * (column + 0.5) / (kAzimuths * kInner);
            const double density = sampling.density(to_viewer({1.0, mu, 180 - azimuth}));
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

std::vector<double> integrated_albedo(const BrdfSource& source, double mu_in) {
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
