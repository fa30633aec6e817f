#include "pipeline/formats/check/check.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "pipeline/solve/vector_pairs.h"

namespace miebrdf {
namespace {

/// Values below this share of the mean are compared with that share.
constexpr double kTail = 0.01;
/// The tail near the horizon, where a refracting boundary lets less and less through and light
/// counts with its small cosine: of the mean over all directions.
constexpr double kGrazingTail = 0.5;

/// Gives one sequence everywhere; std::uniform_real_distribution does not.
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

std::vector<Direction> lobe_directions(std::size_t count, std::uint64_t seed, double lowest,
                                       double highest) {
    Uniform uniform(seed);
    constexpr double kLeastTilt = 1e-3, kLargestTilt = 0.5;
    std::vector<Direction> directions;
    while (directions.size() < count) {
        const double mu_in = lowest + (highest - lowest) * uniform();
        const double tilt = kLeastTilt * std::pow(kLargestTilt / kLeastTilt, uniform());
        const double turn = 2.0 * std::numbers::pi * uniform();
        const Eigen::Vector3d in = spherical(std::acos(mu_in), 0.0);
        const Eigen::Vector3d out = mirrored(in, spherical(tilt, turn));
        if (out.z() > lowest && out.z() <= highest) directions.push_back(direction_of(in, out));
    }
    return directions;
}

namespace {

/// `axis` turned by 0.001 to 0.1 rad, evenly in its logarithm, in any direction; every tenth of
/// `number` stays.
Eigen::Vector3d turned_a_little(const Eigen::Vector3d& axis, std::size_t number, Uniform& uniform) {
    constexpr double kLeast = 1e-3, kLargest = 0.1;
    const double angle = kLeast * std::pow(kLargest / kLeast, uniform());
    const double turn = 2.0 * std::numbers::pi * uniform();
    if (number % 10 == 0) return axis;
    const Eigen::Vector3d across = axis.unitOrthogonal(), third = axis.cross(across);
    return std::cos(angle) * axis +
           std::sin(angle) * (std::cos(turn) * across + std::sin(turn) * third);
}

constexpr double kLeastCosine = 0.2;  // of the directions about peaks

}  // namespace

std::vector<Direction> retro_directions(std::size_t count, std::uint64_t seed) {
    Uniform uniform(seed);
    std::vector<Direction> directions;
    for (std::size_t i = 0; directions.size() < count; ++i) {
        const double mu_in = kLeastCosine + (1.0 - kLeastCosine) * uniform();
        const Eigen::Vector3d in = spherical(std::acos(mu_in), 0.0);
        const Eigen::Vector3d out = turned_a_little(in, i, uniform);
        if (out.z() > kLeastCosine) directions.push_back(direction_of(in, out));
    }
    return directions;
}

std::vector<Direction> zenith_directions(std::size_t count, std::uint64_t seed) {
    Uniform uniform(seed);
    std::vector<Direction> directions;
    for (std::size_t i = 0; i < count; ++i) {
        const Eigen::Vector3d near = turned_a_little(Eigen::Vector3d::UnitZ(), i, uniform);
        const double mu = kLeastCosine + (1.0 - kLeastCosine) * uniform();
        Direction direction{near.z(), mu, 360.0 * uniform()};
        if (uniform() < 0.5) std::swap(direction.mu_in, direction.mu_out);
        directions.push_back(direction);
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

enum class Measure { each, together };

/// Nothing is missed where nothing is (a black ground).
double relative_to(double least, double error, double truth) {
    return error == 0.0 ? 0.0 : error / std::max(std::abs(truth), least);
}

/// The findings in one region: relative errors of each value, or of all values together.
struct RegionSums {
    double squares = 0.0, values = 0.0;
    RegionDeviation region;

    RegionDeviation result() const {
        RegionDeviation found = region;
        found.rms = squares > 0.0 && values > 0.0 ? std::sqrt(squares / values) : 0.0;
        return found;
    }
};

/// @param everywhere  mean over all directions
RegionDeviation measure_region(const RegionDeviation& region, Measure measure, const BrdfFile& file,
                               const BrdfSource& source, double everywhere,
                               std::span<const Direction> directions) {
    const std::size_t channels = source.channels().size();
    std::vector<double> expected(directions.size() * channels), found(channels);
    source.evaluate(directions, expected);
    double mean = 0.0;
    for (const double value : expected) mean += std::abs(value) / double(expected.size());
    const double least =
        region.kind == RegionKind::grazing ? kGrazingTail * everywhere : kTail * mean;
    RegionSums sums;
    sums.region = region;
    for (std::size_t d = 0; d < directions.size(); ++d) {
        file.evaluate(directions[d], found);
        for (std::size_t c = 0; c < channels; ++c) {
            if (std::isnan(found[c])) continue;
            const double truth = expected[d * channels + c], error = found[c] - truth;
            const double relative = relative_to(least, error, truth);
            sums.squares += measure == Measure::each ? relative * relative : error * error;
            sums.values += measure == Measure::each ? 1.0 : truth * truth;
            if (std::abs(relative) <= std::abs(sums.region.worst)) continue;
            sums.region.worst = relative;
            sums.region.where = directions[d];
        }
    }
    return sums.result();
}

}  // namespace

AcceptedErrors AcceptedErrors::with_plain(double least) const {
    return {least, std::max(peaks, least), std::max(grazing, least)};
}

const RegionDeviation* worst_region(const Deviation& deviation, const AcceptedErrors& accepted) {
    const RegionDeviation* worst = nullptr;
    double largest = 1.0;  // of what is allowed
    for (const RegionDeviation& region : deviation.regions) {
        const double share = region.rms / accepted.of(region.kind);
        if (share <= largest) continue;
        worst = &region;
        largest = share;
    }
    return worst;
}

Deviation measure_deviation(const BrdfFile& file, const BrdfSource& source,
                            std::span<const Direction> directions, bool peaks) {
    const std::size_t channels = source.channels().size();
    if (file.channels().size() != channels) {
        throw UsageError(fmt::format("the file has {} channels ({}), the BRDF {}",
                                     file.channels().size(), fmt::join(file.channels(), ", "),
                                     channels));
    }
    std::vector<double> expected(directions.size() * channels), found(channels);
    source.evaluate(directions, expected);
    Deviation deviation;
    std::array<RegionSums, 3> bands;
    for (std::size_t b = 0; b < 3; ++b) {
        bands[b].region.name = kDeviationBands[b];
        bands[b].region.kind = b == 0 ? RegionKind::plain : RegionKind::grazing;
    }
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
        RegionSums& band = bands[band_of(directions[d])];
        const double tail = band.region.kind == RegionKind::plain ? kTail : kGrazingTail;
        for (std::size_t c = 0; c < channels; ++c) {
            const double truth = expected[d * channels + c];
            const double error = found[c] - truth;
            const double relative = relative_to(tail * std::abs(mean), error, truth);
            deviation.largest = std::max(deviation.largest, std::abs(error) / mean);
            band.squares += relative * relative;
            band.values += 1.0;
            if (std::abs(relative) <= std::abs(band.region.worst)) continue;
            band.region.worst = relative;
            band.region.where = directions[d];
        }
    }
    for (std::size_t b = 0; b < 3; ++b) {
        deviation.regions.push_back(bands[b].result());
        deviation.rms[b] = deviation.regions.back().rms;
    }
    if (!peaks) return deviation;
    constexpr std::size_t kCount = 500;
    const auto add = [&](const char* name, RegionKind kind, Measure measure,
                         const std::vector<Direction>& list) {
        RegionDeviation region;
        region.name = name;
        region.kind = kind;
        deviation.regions.push_back(
            measure_region(region, measure, file, source, std::abs(mean), list));
        return deviation.regions.back().rms;
    };
    deviation.lobe =
        add("near mirror", RegionKind::plain, Measure::together, lobe_directions(kCount, 77));
    add("near mirror, mu < 0.2", RegionKind::grazing, Measure::each,
        lobe_directions(kCount, 78, 0.005, 0.2));
    add("retro-reflection", RegionKind::peaks, Measure::each, retro_directions(kCount, 79));
    add("zenith", RegionKind::peaks, Measure::each, zenith_directions(kCount, 80));
    return deviation;
}

}  // namespace miebrdf
