#include "pipeline/exports/azimuth_series.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "pipeline/error.h"
#include "pipeline/parallel.h"

namespace miebrdf::exports {
namespace {

/// Pairs of one job; each has hundreds of samples.
constexpr std::size_t kPairsOfJob = 32;
constexpr int kFirstOrders = 64;

/// Row k, column j: weight of sample j, at azimuth pi j / n, in coefficient k <= n.
std::vector<double> dct_matrix(int n) {
    const auto size = static_cast<std::size_t>(n + 1);
    std::vector<double> matrix(size * size);
    for (std::size_t k = 0; k < size; ++k) {
        for (std::size_t j = 0; j < size; ++j) {
            const bool end_sample = j == 0 || j + 1 == size;
            const bool end_order = k == 0 || k + 1 == size;
            // k j modulo 2 n keeps the argument small, so that the cosine keeps its digits.
            const double angle =
                std::numbers::pi * static_cast<double>((k * j) % (2 * (size - 1))) / n;
            matrix[k * size + j] =
                2.0 / n * (end_sample ? 0.5 : 1.0) * (end_order ? 0.5 : 1.0) * std::cos(angle);
        }
    }
    return matrix;
}

/// One number of orders: n + 1 samples of half a turn and their DCT.
struct Level {
    int n;
    std::vector<double> dct;
};

std::vector<Level> levels_up_to(int most_orders) {
    std::vector<Level> levels;
    int n = std::min(kFirstOrders, most_orders);
    levels.push_back({n, dct_matrix(n)});
    while (n < most_orders) {
        n = std::min(2 * n, most_orders);
        levels.push_back({n, dct_matrix(n)});
    }
    return levels;
}

/// Samples of one pair at azimuths 180 j / n degrees, [j * channels + c]. With twice the n, every
/// other one is known.
void refine(const BrdfSource& source, const CosinePair& pair, int n, std::vector<double>& samples) {
    const std::size_t channels = source.channels().size();
    const auto size = static_cast<std::size_t>(n + 1);
    const bool nested = n % 2 == 0 && samples.size() == (size / 2 + 1) * channels;
    std::vector<Direction> directions;
    for (std::size_t j = nested ? 1 : 0; j < size; j += nested ? 2 : 1)
        directions.push_back({pair.mu_in, pair.mu_out, 180.0 * static_cast<double>(j) / n});
    std::vector<double> fresh(directions.size() * channels), all(size * channels);
    source.evaluate(directions, fresh);
    for (std::size_t i = 0; i < all.size(); ++i) {
        const std::size_t j = i / channels, c = i % channels;
        const bool known = nested && j % 2 == 0;
        all[i] = (known ? samples : fresh)[(nested ? j / 2 : j) * channels + c];
    }
    samples = std::move(all);
}

/// The coefficients of one pair, [channel * (n + 1) + k].
std::vector<double> transform(const std::vector<double>& samples, std::size_t channels,
                              const Level& level) {
    const auto size = static_cast<std::size_t>(level.n + 1);
    std::vector<double> coefficients(size * channels, 0.0);
    for (std::size_t c = 0; c < channels; ++c) {
        for (std::size_t k = 0; k < size; ++k) {
            double sum = 0.0;
            for (std::size_t j = 0; j < size; ++j)
                sum += level.dct[k * size + j] * samples[j * channels + c];
            coefficients[c * size + k] = sum;
        }
    }
    return coefficients;
}

double tail_of(const std::vector<double>& coefficients, std::size_t channels) {
    const std::size_t size = coefficients.size() / channels;
    double tail = 0.0;
    for (std::size_t c = 0; c < channels; ++c) {
        const double* a = &coefficients[c * size];
        for (std::size_t k = size - size / 8; k < size && a[0] != 0.0; ++k)
            tail = std::max(tail, std::abs(a[k] / a[0]));
    }
    return tail;
}

}  // namespace

AzimuthSeries azimuth_series(const BrdfSource& source, std::span<const CosinePair> pairs,
                             double tail_tolerance, int most_orders, const RunControl& control) {
    if (!(most_orders >= 16 && most_orders <= 4096)) {
        throw UsageError(
            fmt::format("azimuthal orders: {} is out of range; allowed: 16 to 4096", most_orders));
    }
    const std::vector<Level> levels = levels_up_to(most_orders);
    AzimuthSeries series{source.channels().size(), {}, 0.0};
    series.coefficients.resize(pairs.size());
    const std::size_t jobs = (pairs.size() + kPairsOfJob - 1) / kPairsOfJob;
    std::vector<double> tails(jobs);
    run_parallel("azimuth series", jobs, control, [&](std::size_t job) {
        const std::size_t last = std::min(pairs.size(), (job + 1) * kPairsOfJob);
        for (std::size_t p = job * kPairsOfJob; p < last; ++p) {
            double tail = 0.0;
            std::vector<double> samples;
            for (const Level& level : levels) {
                refine(source, pairs[p], level.n, samples);
                series.coefficients[p] = transform(samples, series.channels, level);
                tail = tail_of(series.coefficients[p], series.channels);
                if (tail <= tail_tolerance) break;
            }
            tails[job] = std::max(tails[job], tail);
        }
    });
    for (const double tail : tails) series.tail = std::max(series.tail, tail);
    return series;
}

}  // namespace miebrdf::exports
