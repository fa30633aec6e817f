#include "pipeline/formats/pbrt/azimuth_series.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <unsupported/Eigen/FFT>

#include <miebrdf/error.h>
#include "pipeline/solve/parallel.h"

namespace miebrdf {
namespace {

/// Pairs of one job; each has hundreds of samples.
constexpr std::size_t kPairsOfJob = 32;
constexpr int kFirstOrders = 64;
/// Samples of half a turn for peaks that the orders do not resolve: one every 80 arc seconds.
constexpr int kMostSamples = 8192;
/// Their mean has settled when it changes by less.
constexpr double kSettled = 1e-3;

/// Numbers of intervals of half a turn to try.
std::vector<int> levels_up_to(int most_orders) {
    std::vector<int> levels = {std::min(kFirstOrders, most_orders)};
    while (levels.back() < most_orders) levels.push_back(std::min(2 * levels.back(), most_orders));
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

/// The coefficients of one pair, [channel * (n + 1) + k]: the Fourier transform of the whole turn,
/// which mirrors the half.
std::vector<double> transform(const std::vector<double>& samples, std::size_t channels,
                              Eigen::FFT<double>& fft) {
    const std::size_t size = samples.size() / channels, n = size - 1;
    std::vector<double> coefficients(size * channels), turn(2 * n);
    std::vector<std::complex<double>> spectrum;
    for (std::size_t c = 0; c < channels; ++c) {
        for (std::size_t j = 0; j < 2 * n; ++j)
            turn[j] = samples[std::min(j, 2 * n - j) * channels + c];
        fft.fwd(spectrum, turn);
        for (std::size_t k = 0; k < size; ++k) {
            const double both_signs = k == 0 || k == n ? 1.0 : 2.0;
            coefficients[c * size + k] =
                both_signs * spectrum[k].real() / static_cast<double>(2 * n);
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

/// Whether the means of the two agree.
bool settled(const std::vector<double>& before, const std::vector<double>& now,
             std::size_t channels) {
    const std::size_t old_size = before.size() / channels, size = now.size() / channels;
    for (std::size_t c = 0; c < channels; ++c) {
        const double mean = now[c * size];
        if (!(std::abs(before[c * old_size] - mean) <= kSettled * std::abs(mean))) return false;
    }
    return true;
}

/// The first orders, damped by Jackson's factors (Weisse et al. 2006, Rev. Mod. Phys. 78, eq. 71):
/// their kernel is positive, so a peak comes out wider and lower, with the same mean, and nothing
/// rings around it.
std::vector<double> tapered(const std::vector<double>& coefficients, std::size_t channels,
                            int orders) {
    const std::size_t size = coefficients.size() / channels;
    const auto kept = static_cast<std::size_t>(orders) + 1;
    const double step = std::numbers::pi / double(kept + 1);
    std::vector<double> list(kept * channels);
    for (std::size_t k = 0; k < kept; ++k) {
        const double x = double(k) * step;
        const double factor =
            (double(kept + 1 - k) * std::cos(x) + std::sin(x) / std::tan(step)) / double(kept + 1);
        for (std::size_t c = 0; c < channels; ++c)
            list[c * kept + k] = factor * coefficients[c * size + k];
    }
    return list;
}

/// A series whose tail does not vanish: more samples for what its orders still can say, for the
/// mean above all, then the taper.
void taper(const BrdfSource& source, const CosinePair& pair, int orders,
           std::vector<double>& samples, Eigen::FFT<double>& fft, AzimuthSeries& series) {
    std::vector<double> finer = series.coefficients;
    for (int n = 2 * orders; n <= kMostSamples; n *= 2) {
        refine(source, pair, n, samples);
        const std::vector<double> now = transform(samples, series.channels, fft);
        const bool done = settled(finer, now, series.channels);
        finer = now;
        if (done) break;
    }
    series.coefficients = tapered(finer, series.channels, orders);
}

}  // namespace

void azimuth_series(const BrdfSource& source, std::span<const CosinePair> pairs,
                    double tail_tolerance, int most_orders, const Control& control,
                    const std::function<void(std::size_t pair, const AzimuthSeries&)>& take) {
    if (!(most_orders >= 16 && most_orders <= 4096)) {
        throw UsageError(
            fmt::format("azimuthal orders: {} is out of range; allowed: 16 to 4096", most_orders));
    }
    const std::vector<int> levels = levels_up_to(most_orders);
    const std::size_t jobs = (pairs.size() + kPairsOfJob - 1) / kPairsOfJob;
    run_parallel("azimuth series", jobs, control, [&](std::size_t job) {
        const std::size_t last = std::min(pairs.size(), (job + 1) * kPairsOfJob);
        Eigen::FFT<double> fft;  // keeps its plans
        AzimuthSeries series{source.channels().size(), {}, 0.0};
        for (std::size_t p = job * kPairsOfJob; p < last; ++p) {
            std::vector<double> samples;
            for (const int n : levels) {
                refine(source, pairs[p], n, samples);
                series.coefficients = transform(samples, series.channels, fft);
                series.tail = tail_of(series.coefficients, series.channels);
                if (series.tail <= tail_tolerance) break;
            }
            if (series.tail > tail_tolerance)
                taper(source, pairs[p], levels.back(), samples, fft, series);
            take(p, series);
        }
    });
}

}  // namespace miebrdf
