#include "pipeline/formats/pbrt_writer.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <numbers>

#include <miebrdf/error.h>
#include "pipeline/formats/azimuth_series.h"
#include "pipeline/formats/binary_writer.h"
#include "pipeline/formats/metadata.h"

namespace miebrdf::exports {
namespace {

/// The horizon: R changes like mu ln mu there, so this is its limit to single precision.
constexpr double kHorizon = 1e-9;

/// pbrt-v3's luminance of linear sRGB (core/spectrum.h); its reader rebuilds G from Y, R and B.
constexpr double kLuminance[3] = {0.212671, 0.715160, 0.072169};

/// Where a series of one pair of nodes lies in the block of coefficients.
struct Extent {
    std::uint32_t offset = 0;
    std::uint32_t length = 0;
};

/// The running integral that pbrt and layerlab invert to sample a direction: exact for the
/// Catmull-Rom spline through f on nodes x.
std::vector<float> spline_integral(const std::vector<float>& x, const std::vector<double>& f) {
    const std::size_t n = x.size();
    std::vector<float> integral(n, 0.0f);
    double sum = 0.0;
    for (std::size_t i = 0; i + 1 < n; ++i) {
        const double width = double(x[i + 1]) - x[i];
        if (width > 0.0) {
            const double slope_0 =
                i > 0 ? width * (f[i + 1] - f[i - 1]) / (double(x[i + 1]) - x[i - 1])
                      : f[i + 1] - f[i];
            const double slope_1 =
                i + 2 < n ? width * (f[i + 2] - f[i]) / (double(x[i + 2]) - x[i]) : f[i + 1] - f[i];
            sum += ((slope_0 - slope_1) / 12.0 + (f[i] + f[i + 1]) / 2.0) * width;
        }
        integral[i + 1] = static_cast<float>(sum);
    }
    return integral;
}

/// The tables of one file. Node index r counts from mu = -1; h and h + 1 are both mu = 0.
class FourierTables {
  public:
    FourierTables(const RgbSource& source, const PbrtOptions& options, const RunControl& control)
        : h_(static_cast<std::size_t>(options.intervals)), nodes_(2 * h_ + 2) {
        for (std::size_t k = 0; k <= h_; ++k) {
            const double sine =
                std::sin(std::numbers::pi * static_cast<double>(k) / (2.0 * options.intervals));
            nodes_[h_ + 1 + k] = static_cast<float>(sine * sine);
            nodes_[h_ - k] = -nodes_[h_ + 1 + k];
        }
        const std::vector<CosinePair> pairs = lit_pairs();
        extents_.resize(nodes_.size() * nodes_.size());
        mean_.assign(nodes_.size() * nodes_.size(), 0.0);
        blocks_.resize(pairs.size());
        azimuth_series(source, pairs, options.tail_tolerance, options.most_orders, control,
                       [&](std::size_t pair, const AzimuthSeries& series) {
                           blocks_[pair] =
                               block_of(series, pairs[pair].mu_in, options.tail_tolerance);
                       });
        for (std::size_t p = 0; p < pairs.size(); ++p) place(p);
        // The row below the horizon repeats the one above, so that a spline across the double node
        // sees no jump: same coefficients, no second copy.
        for (std::size_t c = 0; c < h_; ++c) {
            extents_[index(h_, c)] = extents_[index(h_ + 1, c)];
            mean_[index(h_, c)] = mean_[index(h_ + 1, c)];
        }
    }

    void write(std::ostream& out, const std::string& description) const {
        BinaryWriter binary(out);
        binary.put_text("SCATFUN");
        binary.put(std::uint8_t{1});
        for (const std::size_t field :
             {std::size_t{1}, nodes_.size(), coefficients_, longest_, std::size_t{3},
              std::size_t{1}, description.size(), std::size_t{0}, std::size_t{0}}) {
            binary.put(static_cast<std::uint32_t>(field));
        }
        for (const float field : {1.0f, 0.0f, 0.0f, 0.0f, 0.0f}) binary.put(field);  // eta, alphas
        binary.put_all(nodes_);
        for (std::size_t r = 0; r < nodes_.size(); ++r) {
            const auto row = mean_.begin() + static_cast<std::ptrdiff_t>(index(r, 0));
            binary.put_all(
                spline_integral(nodes_, {row, row + static_cast<std::ptrdiff_t>(nodes_.size())}));
        }
        for (const Extent& extent : extents_) {
            binary.put(extent.offset);
            binary.put(extent.length);
        }
        for (const std::vector<float>& block : blocks_) binary.put_all(block);
        binary.put_text(description);
    }

  private:
    std::size_t index(std::size_t row, std::size_t column) const {
        return row * nodes_.size() + column;
    }

    /// Row = direction of the camera, at mu >= 0; column = minus the direction of the light. At the
    /// light's own horizon f * mu is 0: those series stay empty.
    std::vector<CosinePair> lit_pairs() {
        std::vector<CosinePair> pairs;
        for (std::size_t r = h_ + 1; r < nodes_.size(); ++r) {
            for (std::size_t c = 0; c < h_; ++c) {
                pairs.push_back({-double(nodes_[c]), std::max(double(nodes_[r]), kHorizon)});
            }
        }
        return pairs;
    }

    /// Y, R and B of one pair, times the cosine, as far as any of them counts.
    static std::vector<float> block_of(const AzimuthSeries& series, double mu_in,
                                       double tail_tolerance) {
        const std::size_t orders = series.orders();
        std::vector<double> y_r_b(3 * orders);
        std::size_t length = 1;
        for (std::size_t k = 0; k < orders; ++k) {
            const double rgb[3] = {series.of(0)[k], series.of(1)[k], series.of(2)[k]};
            const double y =
                kLuminance[0] * rgb[0] + kLuminance[1] * rgb[1] + kLuminance[2] * rgb[2];
            const double channels[3] = {y * mu_in, rgb[0] * mu_in, rgb[2] * mu_in};
            for (std::size_t c = 0; c < 3; ++c) {
                y_r_b[c * orders + k] = channels[c];
                if (std::abs(channels[c]) > tail_tolerance * std::abs(y_r_b[c * orders]))
                    length = k + 1;
            }
        }
        std::vector<float> block;
        block.reserve(3 * length);
        for (std::size_t c = 0; c < 3; ++c) {
            for (std::size_t k = 0; k < length; ++k)
                block.push_back(static_cast<float>(y_r_b[c * orders + k]));
        }
        return block;
    }

    void place(std::size_t pair) {
        const std::size_t row = h_ + 1 + pair / h_, column = pair % h_;
        const std::size_t length = blocks_[pair].size() / 3;
        if (coefficients_ + 3 * length > std::numeric_limits<std::uint32_t>::max()) {
            throw UsageError(
                "format 'pbrt': more than 2^32 coefficients; allow fewer orders or nodes");
        }
        extents_[index(row, column)] = {static_cast<std::uint32_t>(coefficients_),
                                        static_cast<std::uint32_t>(length)};
        mean_[index(row, column)] = blocks_[pair][0];
        longest_ = std::max(longest_, length);
        coefficients_ += 3 * length;
    }

    std::size_t h_;
    std::vector<float> nodes_;
    std::vector<std::vector<float>> blocks_;  ///< of each lit pair; in the file one after another
    std::size_t coefficients_ = 0;            ///< in all blocks
    std::vector<Extent> extents_;
    std::vector<double> mean_;  ///< a_0 of Y, what the CDF is made of
    std::size_t longest_ = 1;
};

}  // namespace

void write_pbrt(const RgbSource& source, const PbrtOptions& options, std::ostream& out,
                const RunControl& control) {
    if (!(options.intervals >= 4 && options.intervals <= 500)) {
        throw UsageError(fmt::format("pbrt: {} intervals are out of range; allowed: 4 to 500",
                                     options.intervals));
    }
    const FourierTables tables(source, options, control);
    auto description = metadata(source, {.format = "pbrt",
                                         .cosine_included = true,
                                         .azimuth_zero = "mirror side",
                                         .colour = source.weights().description});
    description["channels"] = {"Y", "R", "B"};
    tables.write(out, description.dump());
}

}  // namespace miebrdf::exports
