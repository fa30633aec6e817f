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
constexpr std::size_t kPairsOfJob = 64;

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

class Analysis {
  public:
    Analysis(const BrdfSource& source, std::span<const CosinePair> pairs, int n)
        : source_(source),
          pairs_(pairs),
          size_(static_cast<std::size_t>(n + 1)),
          dct_(dct_matrix(n)) {
        series_.orders = n + 1;
        series_.channels = source.channels().size();
        series_.coefficients.resize(pairs.size() * series_.channels * size_);
    }

    AzimuthSeries run(const RunControl& control) {
        const std::size_t jobs = (pairs_.size() + kPairsOfJob - 1) / kPairsOfJob;
        std::vector<double> tails(jobs);
        run_parallel("azimuth series", jobs, control, [&](std::size_t job) {
            const std::size_t last = std::min(pairs_.size(), (job + 1) * kPairsOfJob);
            for (std::size_t p = job * kPairsOfJob; p < last; ++p) {
                tails[job] = std::max(tails[job], analyse(p));
            }
        });
        for (const double tail : tails) series_.tail = std::max(series_.tail, tail);
        return std::move(series_);
    }

  private:
    /// Fills the coefficients of a pair and returns its tail.
    double analyse(std::size_t pair) {
        std::vector<Direction> directions(size_);
        for (std::size_t j = 0; j < size_; ++j) {
            const double azimuth_deg =
                180.0 * static_cast<double>(j) / static_cast<double>(size_ - 1);
            directions[j] = {pairs_[pair].mu_in, pairs_[pair].mu_out, azimuth_deg};
        }
        std::vector<double> samples(size_ * series_.channels);
        source_.evaluate(directions, samples);
        double tail = 0.0;
        for (std::size_t c = 0; c < series_.channels; ++c) {
            double* a = &series_.coefficients[(pair * series_.channels + c) * size_];
            for (std::size_t k = 0; k < size_; ++k) {
                double sum = 0.0;
                for (std::size_t j = 0; j < size_; ++j) {
                    sum += dct_[k * size_ + j] * samples[j * series_.channels + c];
                }
                a[k] = sum;
                if (k >= size_ - size_ / 8 && a[0] != 0.0) {
                    tail = std::max(tail, std::abs(a[k] / a[0]));
                }
            }
        }
        return tail;
    }

    const BrdfSource& source_;
    std::span<const CosinePair> pairs_;
    std::size_t size_;
    std::vector<double> dct_;
    AzimuthSeries series_;
};

}  // namespace

AzimuthSeries azimuth_series(const BrdfSource& source, std::span<const CosinePair> pairs,
                             double tail_tolerance, int most_orders, const RunControl& control) {
    if (!(most_orders >= 16 && most_orders <= 4096)) {
        throw UsageError(
            fmt::format("azimuthal orders: {} is out of range; allowed: 16 to 4096", most_orders));
    }
    for (int n = 16;; n *= 2) {
        AzimuthSeries series = Analysis(source, pairs, std::min(n, most_orders)).run(control);
        if (series.tail <= tail_tolerance || n >= most_orders) return series;
    }
}

}  // namespace miebrdf::exports
