#include "pipeline/formats/check/check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "pipeline/solve/vector_pairs.h"

namespace miebrdf {
namespace {

/// Of the mean: smaller values are compared with this share of it.
constexpr double kTail = 0.01;

/// The same sequence everywhere; std::uniform_real_distribution is not.
class Uniform {
  public:
    explicit Uniform(std::uint64_t seed) : engine_(seed) {}
    /// In (0, 1).
    double operator()() { return (static_cast<double>(engine_() >> 12) + 0.5) * 0x1p-52; }

  private:
    std::mt19937_64 engine_;
};

std::size_t band_of(const Direction& direction) {
    const double smallest = std::min(direction.mu_in, direction.mu_out);
    return smallest > 0.2 ? 0 : smallest > 0.05 ? 1 : 2;
}

}  // namespace

std::vector<Direction> random_directions(std::size_t count, std::uint64_t seed) {
    Uniform uniform(seed);
    constexpr double kLower[3] = {0.2, 0.05, 0.005}, kUpper[3] = {1.0, 0.2, 0.05};
    std::vector<Direction> directions;
    for (std::size_t i = 0; i < count; ++i) {
        const std::size_t band = i % 3;
        double low = kLower[band] + (kUpper[band] - kLower[band]) * uniform();
        double other = low + (1.0 - low) * uniform();
        if (uniform() < 0.5) std::swap(low, other);
        directions.push_back({low, other, 360.0 * uniform()});
    }
    return directions;
}

std::vector<Direction> lobe_directions(std::size_t count, std::uint64_t seed) {
    Uniform uniform(seed);
    constexpr double kLeastTilt = 1e-3, kLargestTilt = 0.5, kLeastCosine = 0.4;
    std::vector<Direction> directions;
    while (directions.size() < count) {
        const double mu_in = kLeastCosine + (1.0 - kLeastCosine) * uniform();
        const double tilt = kLeastTilt * std::pow(kLargestTilt / kLeastTilt, uniform());
        const double turn = 2.0 * std::numbers::pi * uniform();
        const Eigen::Vector3d in = spherical(std::acos(mu_in), 0.0);
        const Eigen::Vector3d out = mirrored(in, spherical(tilt, turn));
        if (out.z() > kLeastCosine) directions.push_back(direction_of(in, out));
    }
    return directions;
}

std::vector<Direction> random_listed(const ListedDirections& lists, std::size_t count,
                                     std::uint64_t seed) {
    std::mt19937_64 engine(seed);
    const auto draw = [&](const std::vector<double>& list) { return list[engine() % list.size()]; };
    std::vector<Direction> directions;
    for (std::size_t i = 0; i < count; ++i) {
        const double mu_in = draw(lists.mu_in), mu_out = draw(lists.mu_out);
        directions.push_back({mu_in, mu_out, draw(lists.azimuth_deg)});
    }
    return directions;
}

namespace {

double lobe_error(const BrdfFile& file, const BrdfSource& source) {
    const std::vector<Direction> directions = lobe_directions(500, 77);
    const std::size_t channels = source.channels().size();
    std::vector<double> expected(directions.size() * channels), found(channels);
    source.evaluate(directions, expected);
    double errors = 0.0, values = 0.0;
    for (std::size_t d = 0; d < directions.size(); ++d) {
        file.evaluate(directions[d], found);
        for (std::size_t c = 0; c < channels; ++c) {
            if (std::isnan(found[c])) continue;
            const double truth = expected[d * channels + c];
            errors += (found[c] - truth) * (found[c] - truth);
            values += truth * truth;
        }
    }
    return errors > 0.0 ? std::sqrt(errors / values) : 0.0;
}

}  // namespace

Deviation measure_deviation(const BrdfFile& file, const BrdfSource& source,
                            std::span<const Direction> directions) {
    const std::size_t channels = source.channels().size();
    if (file.channels().size() != channels) {
        throw UsageError(fmt::format("the file has {} channels ({}), the BRDF {}",
                                     file.channels().size(), fmt::join(file.channels(), ", "),
                                     channels));
    }
    std::vector<double> expected(directions.size() * channels), found(channels);
    source.evaluate(directions, expected);
    Deviation deviation;
    std::array<double, 3> sums = {0.0, 0.0, 0.0}, counts = {0.0, 0.0, 0.0};
    double mean = 0.0;
    for (const double value : expected) mean += value / static_cast<double>(expected.size());
    for (std::size_t d = 0; d < directions.size(); ++d) {
        file.evaluate(directions[d], found);
        if (std::any_of(found.begin(), found.end(),
                        [](double value) { return std::isnan(value); })) {
            ++deviation.missing;
            continue;
        }
        ++deviation.directions;
        const std::size_t band = band_of(directions[d]);
        for (std::size_t c = 0; c < channels; ++c) {
            const double truth = expected[d * channels + c];
            const double error = found[c] - truth;
            deviation.largest = std::max(deviation.largest, std::abs(error) / mean);
            sums[band] += std::pow(error / std::max(std::abs(truth), kTail * std::abs(mean)), 2);
            counts[band] += 1.0;
        }
    }
    for (std::size_t b = 0; b < 3; ++b)
        deviation.rms[b] = counts[b] > 0 ? std::sqrt(sums[b] / counts[b]) : 0.0;
    deviation.lobe = lobe_error(file, source);
    return deviation;
}

}  // namespace miebrdf
