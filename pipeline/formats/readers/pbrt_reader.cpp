// SCATFUN Fourier files, evaluated as pbrt-v3's FourierBSDF does.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "pipeline/formats/readers/brdf_file.h"
#include "pipeline/formats/readers/catmull_rom.h"
#include "pipeline/formats/readers/scatfun_tables.h"

namespace miebrdf::exports {
namespace {

class PbrtFile : public BrdfFile {
  public:
    explicit PbrtFile(std::string content)
        : content_(std::move(content)), tables_(read_scatfun_tables(content_)) {
        channels_ = tables_.channels == 3 ? std::vector<std::string>{"R", "G", "B"}
                                          : std::vector<std::string>{"Y"};
    }

    std::string format() const override { return "pbrt"; }
    std::string description() const override {
        return fmt::format("Fourier series on {} cosines, longest {} terms", tables_.nodes.size(),
                           tables_.longest);
    }
    const std::vector<std::string>& channels() const override { return channels_; }
    const std::vector<double>& wavelength_nm() const override { return no_wavelengths_; }
    Sampling sampling() const override { return Sampling::from_mu_out; }

    void evaluate(const Direction& direction, std::span<double> values) const override {
        std::fill(values.begin(), values.end(), 0.0);
        const auto row = spline_weights(tables_.nodes, direction.mu_out);
        const auto column = spline_weights(tables_.nodes, -direction.mu_in);
        if (!row || !column) return;
        const double azimuth = direction.azimuth_deg * std::numbers::pi / 180;
        double sums[3] = {0.0, 0.0, 0.0};
        for (std::uint32_t c = 0; c < tables_.channels; ++c) {
            sums[c] = sum_series(*row, *column, c, azimuth) / direction.mu_in;
        }
        sums[0] = std::max(sums[0], 0.0);
        if (tables_.channels == 1) {
            values[0] = sums[0];
            return;
        }
        const double y = sums[0], r = sums[1], b = sums[2];
        values[0] = std::max(r, 0.0);
        values[1] = std::max(1.39829 * y - 0.100913 * b - 0.297375 * r, 0.0);
        values[2] = std::max(b, 0.0);
    }

    /// pbrt samples the light's direction (the column) from that of the camera (the row), first its
    /// cosine by the stored integrals, then the azimuth by the series.
    std::optional<Direction> sample(double mu_out, double u, double v) const override {
        const auto row = spline_weights(tables_.nodes, mu_out);
        if (!row) return {};
        const RowMix mix = mix_rows(*row);
        if (!(mix.cdf.back() > 0)) return {};
        const double mu_in = -sample_spline(tables_.nodes, mix.mean, mix.cdf, u);
        if (!(mu_in > 0)) return {};
        const auto azimuth = sample_azimuth(*row, mu_in, v);
        if (!azimuth) return {};
        return Direction{mu_in, mu_out, *azimuth};
    }

    double density(const Direction& direction) const override {
        const auto row = spline_weights(tables_.nodes, direction.mu_out);
        const auto column = spline_weights(tables_.nodes, -direction.mu_in);
        if (!row || !column) return 0.0;
        const double total = mix_rows(*row).cdf.back();
        const double luminance =
            sum_series(*row, *column, 0, direction.azimuth_deg * std::numbers::pi / 180);
        return total > 0 ? std::max(luminance, 0.0) / (2 * std::numbers::pi * total) : 0.0;
    }

  private:
    /// Mean luminance and its integral over the columns, at a row between the stored ones.
    struct RowMix {
        std::vector<double> mean, cdf;
    };

    RowMix mix_rows(const SplineWeights& row) const {
        const std::size_t n = tables_.nodes.size();
        RowMix mix{std::vector<double>(n, 0.0), std::vector<double>(n, 0.0)};
        for (int i = 0; i < 4; ++i) {
            if (row.weight[i] == 0.0) continue;
            const std::size_t first = static_cast<std::size_t>(row.offset + i) * n;
            for (std::size_t c = 0; c < n; ++c) {
                const ScatfunSeries& series = tables_.series[first + c];
                if (series.length > 0)
                    mix.mean[c] += row.weight[i] * tables_.coefficients[series.offset];
                mix.cdf[c] += row.weight[i] * tables_.cdf[first + c];
            }
        }
        return mix;
    }

    /// The series between the stored pairs: each coefficient interpolated by itself.
    std::vector<double> mix_series(const SplineWeights& row, const SplineWeights& column,
                                   std::uint32_t channel) const {
        std::vector<double> mixed;
        for (int i = 0; i < 4; ++i) {
            for (int j = 0; j < 4; ++j) {
                const double weight = row.weight[i] * column.weight[j];
                if (weight == 0.0) continue;
                const auto r = static_cast<std::size_t>(row.offset + i);
                const auto c = static_cast<std::size_t>(column.offset + j);
                const ScatfunSeries& series = tables_.series[r * tables_.nodes.size() + c];
                const RealView<float> a = tables_.coefficients.part(
                    series.offset + std::size_t{channel} * series.length, series.length);
                if (mixed.size() < series.length) mixed.resize(series.length, 0.0);
                for (std::uint32_t k = 0; k < series.length; ++k) mixed[k] += weight * a[k];
            }
        }
        return mixed;
    }

    /// sum a_k cos(k azimuth) by Clenshaw's recurrence.
    static double sum(const std::vector<double>& a, double azimuth) {
        const double cosine = std::cos(azimuth);
        double next = 0.0, after = 0.0;
        for (std::size_t k = a.size(); k-- > 1;) {
            const double current = a[k] + 2.0 * cosine * next - after;
            after = next;
            next = current;
        }
        return a.empty() ? 0.0 : a[0] + cosine * next - after;
    }

    double sum_series(const SplineWeights& row, const SplineWeights& column, std::uint32_t channel,
                      double azimuth) const {
        return sum(mix_series(row, column, channel), azimuth);
    }

    /// Inverts the integral of the luminance over azimuth on a fine grid; exact enough to test by.
    std::optional<double> sample_azimuth(const SplineWeights& row, double mu_in, double v) const {
        const auto column = spline_weights(tables_.nodes, -mu_in);
        if (!column) return {};
        constexpr int kSteps = 720;
        const std::vector<double> series = mix_series(row, *column, 0);
        std::vector<double> integral(kSteps + 1, 0.0);
        double previous = std::max(sum(series, 0.0), 0.0);
        for (int j = 1; j <= kSteps; ++j) {
            const double value = std::max(sum(series, std::numbers::pi * j / kSteps), 0.0);
            integral[j] = integral[j - 1] + (previous + value) / 2;
            previous = value;
        }
        if (!(integral.back() > 0)) return {};
        const double target = v * integral.back();
        const auto j = static_cast<std::size_t>(
            std::upper_bound(integral.begin(), integral.end() - 1, target) - integral.begin() - 1);
        const double width = integral[j + 1] - integral[j];
        return 180.0 / kSteps *
               (static_cast<double>(j) + (width > 0 ? (target - integral[j]) / width : 0.0));
    }

    std::string content_;
    ScatfunTables tables_;
    std::vector<std::string> channels_;
    std::vector<double> no_wavelengths_;
};

}  // namespace

bool looks_like_pbrt(std::string_view content) { return content.starts_with(kScatfunMagic); }

std::unique_ptr<BrdfFile> read_pbrt(std::string content) {
    return std::make_unique<PbrtFile>(std::move(content));
}

}  // namespace miebrdf::exports
