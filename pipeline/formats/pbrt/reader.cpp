// SCATFUN Fourier files, evaluated as pbrt-v3's FourierBSDF does.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include <miebrdf/brdf_source.h>
#include <miebrdf/formats.h>
#include "pipeline/formats/common/byte_reader.h"

namespace miebrdf {
namespace {

/// A pair's Fourier series: `length` numbers for each channel from `offset` on.
struct ScatfunSeries {
    std::uint32_t offset = 0;
    std::uint32_t length = 0;
};

struct ScatfunTables {
    std::vector<float> nodes;  ///< cosines, ascending
    RealView<float> cdf;       ///< these two where they are in the file
    RealView<float> coefficients;
    std::vector<ScatfunSeries> series;  ///< row = camera, column = light
    std::uint32_t longest = 0;
    std::uint32_t channels = 0;
};

inline constexpr std::string_view kScatfunMagic("SCATFUN\x01", 8);

[[noreturn]] void refuse_pbrt(const std::string& reason) { throw InputError("pbrt: " + reason); }

std::uint32_t expect(ByteReader& bytes, const char* field, std::uint32_t lowest,
                     std::uint32_t highest) {
    const auto value = bytes.number<std::uint32_t>();
    if (value < lowest || value > highest) {
        refuse_pbrt(fmt::format("{} is {}; allowed: {} to {}", field, value, lowest, highest));
    }
    return value;
}

void validate(const ScatfunTables& tables) {
    for (std::size_t i = 0; i < tables.nodes.size(); ++i) {
        const float previous = i == 0 ? -1.0f : tables.nodes[i - 1];
        if (!(tables.nodes[i] >= previous && tables.nodes[i] <= 1.0f)) {
            refuse_pbrt(fmt::format("cosine nodes are not ascending in [-1, 1] at {}", i));
        }
    }
    const std::uint64_t available = tables.coefficients.size();
    for (const ScatfunSeries& series : tables.series) {
        if (series.length > tables.longest ||
            series.offset + std::uint64_t{series.length} * tables.channels > available) {
            refuse_pbrt(
                fmt::format("a series of {} terms at {} does not fit {} coefficients (longest {})",
                            series.length, series.offset, available, tables.longest));
        }
    }
}

/// Views into the content, which must outlive them. Refuses anything that pbrt-v3 would refuse or
/// misread.
ScatfunTables read_scatfun_tables(std::string_view content) {
    ByteReader bytes(content);
    bytes.take(kScatfunMagic.size());
    expect(bytes, "flags", 1, 1);
    ScatfunTables tables;
    const std::uint64_t n = expect(bytes, "nodes", 4, 65536);
    const std::uint64_t coefficients = bytes.number<std::uint32_t>();
    tables.longest = bytes.number<std::uint32_t>();
    tables.channels = bytes.number<std::uint32_t>();
    if (tables.channels != 1 && tables.channels != 3) {
        refuse_pbrt(fmt::format("{} channels; allowed: 1 or 3", tables.channels));
    }
    expect(bytes, "bases", 1, 1);
    const auto metadata = bytes.number<std::uint32_t>();
    expect(bytes, "parameters", 0, 0);
    expect(bytes, "parameter values", 0, 0);
    bytes.take(20);  // eta (of transmission), two roughnesses, two unused
    tables.nodes = bytes.reals<float>(n);
    tables.cdf = bytes.view<float>(n * n);
    if (bytes.remaining() / 8 < n * n) refuse_pbrt("the file ends in the table of series");
    tables.series.resize(n * n);
    for (ScatfunSeries& series : tables.series) {
        series.offset = bytes.number<std::uint32_t>();
        series.length = bytes.number<std::uint32_t>();
    }
    tables.coefficients = bytes.view<float>(coefficients);
    if (bytes.remaining() != metadata) {  // layerlab refuses such files too
        refuse_pbrt(
            fmt::format("{} bytes of metadata announced, {} left", metadata, bytes.remaining()));
    }
    validate(tables);
    return tables;
}

// Catmull-Rom splines on uneven nodes, as pbrt-v3 and layerlab use them (core/interpolation.cpp).

/// value(x) = sum_i weight[i] f[offset + i]; entries outside the table have weight 0.
struct SplineWeights {
    int offset = 0;
    double weight[4] = {0, 0, 0, 0};
};

/// Empty outside [nodes.front(), nodes.back()].
std::optional<SplineWeights> spline_weights(std::span<const float> nodes, double x) {
    const std::size_t n = nodes.size();
    if (n < 2 || !(x >= nodes.front() && x <= nodes.back())) return {};
    const auto above = std::upper_bound(nodes.begin(), nodes.end(), x);
    const std::size_t i = std::min<std::size_t>(
        n - 2, static_cast<std::size_t>(std::max<std::ptrdiff_t>(0, above - nodes.begin() - 1)));
    const double x0 = nodes[i], x1 = nodes[i + 1], width = x1 - x0;
    if (!(width > 0)) return {};
    const double t = (x - x0) / width, t2 = t * t, t3 = t2 * t;
    SplineWeights w;
    w.offset = static_cast<int>(i) - 1;
    w.weight[1] = 2 * t3 - 3 * t2 + 1;
    w.weight[2] = -2 * t3 + 3 * t2;
    double slope = t3 - 2 * t2 + t;
    if (i > 0) {
        slope *= width / (x1 - nodes[i - 1]);
        w.weight[0] = -slope;
    } else {
        w.weight[1] -= slope;
    }
    w.weight[2] += slope;
    slope = t3 - t2;
    if (i + 2 < n) {
        slope *= width / (nodes[i + 2] - x0);
        w.weight[3] = slope;
    } else {
        w.weight[2] += slope;
    }
    w.weight[1] -= slope;
    return w;
}

/// Values and slopes (times the width) of a spline at both ends of an interval.
struct SplineSegment {
    double f0, f1, d0, d1;

    /// From 0 to t.
    double integral(double t) const {
        return t * (f0 + t * (d0 / 2 + t * ((-2 * d0 - d1) / 3 + f1 - f0 +
                                            t * ((d0 + d1) / 4 + (f0 - f1) / 2))));
    }
};

SplineSegment segment_of(std::span<const float> x, std::span<const double> f, std::size_t i) {
    const double width = double(x[i + 1]) - x[i];
    SplineSegment s{f[i], f[i + 1], f[i + 1] - f[i], f[i + 1] - f[i]};
    if (i > 0) s.d0 = width * (f[i + 1] - f[i - 1]) / (double(x[i + 1]) - x[i - 1]);
    if (i + 2 < x.size()) s.d1 = width * (f[i + 2] - f[i]) / (double(x[i + 2]) - x[i]);
    return s;
}

/// Draws x with density proportional to the spline through f, whose running integral is `cdf`.
/// @param u  in [0, 1)
double sample_spline(std::span<const float> nodes, std::span<const double> f,
                     std::span<const double> cdf, double u) {
    const double target = u * cdf.back();
    const auto above = std::upper_bound(cdf.begin(), cdf.end(), target);
    const auto i = static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(
        above - cdf.begin() - 1, 0, static_cast<std::ptrdiff_t>(cdf.size()) - 2));
    const double width = double(nodes[i + 1]) - nodes[i];
    const SplineSegment segment = segment_of(nodes, f, i);
    const double wanted = width > 0 ? (target - cdf[i]) / width : 0.0;
    // The integral rises with t wherever the spline is positive: bisection cannot run away.
    double low = 0.0, high = 1.0;
    for (int step = 0; step < 50; ++step) {
        const double middle = (low + high) / 2;
        (segment.integral(middle) < wanted ? low : high) = middle;
    }
    return nodes[i] + width * (low + high) / 2;
}

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

    void look_up(const Direction& direction, std::span<double> values) const override {
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

Recognised recognise_pbrt(std::string_view content) {
    return content.starts_with(kScatfunMagic) ? Recognised::by_first_bytes : Recognised::no;
}

std::unique_ptr<BrdfFile> read_pbrt(std::string content) {
    return std::make_unique<PbrtFile>(std::move(content));
}

}  // namespace

FormatReader pbrt_reader() { return {recognise_pbrt, read_pbrt}; }

}  // namespace miebrdf
