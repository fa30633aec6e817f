// pbrt: the Fourier BSDF file of pbrt-v3 and layerlab ("SCATFUN"). docs/formats/pbrt.md
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <numbers>

#include "pipeline/formats/common/byte_writer.h"
#include "pipeline/formats/common/export_job.h"
#include "pipeline/formats/pbrt/azimuth_series.h"

namespace miebrdf {

FormatReader pbrt_reader();  // reader.cpp

namespace {

/// The horizon: R changes like mu ln mu there, so this is its limit to single precision.
constexpr double kHorizonCosine = 1e-9;

/// pbrt-v3's luminance of linear sRGB (core/spectrum.h); its reader rebuilds G from Y, R and B.
constexpr double kLuminance[3] = {0.212671, 0.715160, 0.072169};

/// The place of one pair's series in the block of coefficients.
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

/// A series is cut where the rest is below this share of its mean.
constexpr double kTailTolerance = 1e-5;
constexpr int kMostOrders = 512;

/// Series of more orders are of peaks of a degree and less.
constexpr std::size_t kNarrowOrders = 128;

/// A BRDF of which one pair of cosines stands for all pairs around it: means over the triangles
/// that linear interpolation between nodes gives each of them.
class PairMean : public BrdfSource {
  public:
    /// @param below, above  distances to the neighbouring nodes
    struct Extent {
        double below = 0.0, above = 0.0;
    };
    PairMean(const BrdfSource& source, const Extent& in, const Extent& out)
        : source_(source), in_(in), out_(out) {}

    const std::vector<std::string>& channels() const override { return source_.channels(); }
    const std::vector<double>& wavelength_nm() const override { return source_.wavelength_nm(); }
    const Provenance& provenance() const override { return source_.provenance(); }

    void evaluate(std::span<const Direction> directions, std::span<double> values) const override {
        constexpr int kPoints = 16;  // evenly spread (R-sequence of two dimensions)
        constexpr double kStep[2] = {0.7548776662466927, 0.5698402909980532};
        std::fill(values.begin(), values.end(), 0.0);
        std::vector<Direction> moved(directions.begin(), directions.end());
        std::vector<double> found(values.size());
        for (int p = 0; p < kPoints; ++p) {
            const auto number = [&](std::size_t axis) {
                const double multiple = 0.5 + (p + 1) * kStep[axis];
                return multiple - std::floor(multiple);
            };
            for (std::size_t d = 0; d < moved.size(); ++d) {
                moved[d].mu_in = shifted(directions[d].mu_in, in_, number(0));
                moved[d].mu_out = shifted(directions[d].mu_out, out_, number(1));
            }
            source_.evaluate(moved, found);
            for (std::size_t i = 0; i < values.size(); ++i) values[i] += found[i] / kPoints;
        }
    }

  private:
    /// Distributed as a triangle over both intervals; a uniform number in (0, 1).
    static double shifted(double mu, const Extent& extent, double uniform) {
        const double share = extent.below / (extent.below + extent.above);
        const double x = uniform < share
                             ? -extent.below * (1.0 - std::sqrt(uniform / share))
                             : extent.above * (1.0 - std::sqrt((1.0 - uniform) / (1.0 - share)));
        return std::clamp(mu + x, kHorizonCosine, 1.0);
    }

    const BrdfSource& source_;
    Extent in_, out_;
};

/// The tables of one file. With h intervals of each half of the cosine axis, nodes are
/// sin^2(pi k / 2h), which crowd at the horizon, where the BRDF bends, and at the normal. Node
/// index r counts from mu = -1; h and h + 1 are both mu = 0.
class FourierTables {
  public:
    FourierTables(const RgbSource& source, int intervals, const Control& control)
        : h_(static_cast<std::size_t>(intervals)), nodes_(2 * h_ + 2) {
        for (std::size_t k = 0; k <= h_; ++k) {
            const double sine =
                std::sin(std::numbers::pi * static_cast<double>(k) / (2.0 * intervals));
            nodes_[h_ + 1 + k] = static_cast<float>(sine * sine);
            nodes_[h_ - k] = -nodes_[h_ + 1 + k];
        }
        const std::vector<CosinePair> pairs = lit_pairs();
        extents_.resize(nodes_.size() * nodes_.size());
        mean_.assign(nodes_.size() * nodes_.size(), 0.0);
        blocks_.resize(pairs.size());
        std::vector<std::uint8_t> narrow(pairs.size(), 0);
        azimuth_series(source, pairs, kTailTolerance, kMostOrders, control,
                       [&](std::size_t pair, const AzimuthSeries& series) {
                           blocks_[pair] = block_of(series, pairs[pair].mu_in);
                           narrow[pair] = series.orders() > kNarrowOrders + 1 ? 1 : 0;
                       });
        widen_ridges(source, pairs, narrow, control);
        for (std::size_t p = 0; p < pairs.size(); ++p) place(p);
        // The row below the horizon repeats the one above, so that a spline across the double node
        // sees no jump: same coefficients, no second copy.
        for (std::size_t c = 0; c < h_; ++c) {
            extents_[index(h_, c)] = extents_[index(h_ + 1, c)];
            mean_[index(h_, c)] = mean_[index(h_ + 1, c)];
        }
    }

    void write(std::ostream& out, const std::string& description) const {
        ByteWriter bytes(out);
        bytes.put_text("SCATFUN");
        bytes.put(std::uint8_t{1});
        for (const std::size_t field :
             {std::size_t{1}, nodes_.size(), coefficients_, longest_, std::size_t{3},
              std::size_t{1}, description.size(), std::size_t{0}, std::size_t{0}}) {
            bytes.put(static_cast<std::uint32_t>(field));
        }
        for (const float field : {1.0f, 0.0f, 0.0f, 0.0f, 0.0f}) bytes.put(field);  // eta, alphas
        bytes.put_all(nodes_);
        for (std::size_t r = 0; r < nodes_.size(); ++r) {
            const auto row = mean_.begin() + static_cast<std::ptrdiff_t>(index(r, 0));
            bytes.put_all(
                spline_integral(nodes_, {row, row + static_cast<std::ptrdiff_t>(nodes_.size())}));
        }
        for (const Extent& extent : extents_) {
            bytes.put(extent.offset);
            bytes.put(extent.length);
        }
        for (const std::vector<float>& block : blocks_) bytes.put_all(block);
        bytes.put_text(description);
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
                pairs.push_back({-double(nodes_[c]), std::max(double(nodes_[r]), kHorizonCosine)});
            }
        }
        return pairs;
    }

    double node_above(std::size_t node) const {
        return node + 1 < nodes_.size() ? double(nodes_[node + 1]) - nodes_[node] : 0.0;
    }
    double node_below(std::size_t node) const {
        return node > 0 ? double(nodes_[node]) - nodes_[node - 1] : 0.0;
    }

    /// Peaks at retro-reflection and mirror directions are ridges along equal cosines. Narrower
    /// than the distance of nodes, they would swing the splines between these by several times
    /// their height: there nodes hold means.
    void widen_ridges(const RgbSource& source, const std::vector<CosinePair>& pairs,
                      const std::vector<std::uint8_t>& narrow, const Control& control) {
        for (std::size_t p = 0; p < pairs.size(); ++p) {
            // Node h + 1 + k is at +mu of node h - k.
            const std::size_t out = h_ + 1 + p / h_, in = 2 * h_ + 1 - p % h_;
            if (narrow[p] == 0 || std::max(in, out) - std::min(in, out) > 1) continue;
            if (out <= h_ + 1) continue;  // the horizon has no node below
            const PairMean mean(source, {node_below(in), node_above(in)},
                                {node_below(out), node_above(out)});
            azimuth_series(mean, {&pairs[p], 1}, kTailTolerance, kMostOrders, control,
                           [&](std::size_t, const AzimuthSeries& series) {
                               blocks_[p] = block_of(series, pairs[p].mu_in);
                           });
        }
    }

    /// Y, R and B of one pair, times the cosine, as far as any of them counts.
    static std::vector<float> block_of(const AzimuthSeries& series, double mu_in) {
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
                if (std::abs(channels[c]) > kTailTolerance * std::abs(y_r_b[c * orders]))
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

/// Reflection from the lit top side, three channels (Y, R, B of linear sRGB). Rows at the horizon
/// hold the limit of the BRDF, on both sides: a subsurface BRDF does not vanish there, and a reader
/// that interpolates towards empty rows loses several per cent of the albedo.
void write_pbrt(const ExportJob& job, std::ostream& out) {
    const FourierTables tables(job.rgb, job.options.resolution, job.control);
    auto description = metadata(job.rgb, {.format = "pbrt",
                                          .cosine_included = true,
                                          .azimuth_zero = "mirror side",
                                          .colour = job.rgb.weights().description});
    description["channels"] = {"Y", "R", "B"};
    tables.write(out, description.dump());
}

}  // namespace

Format pbrt_format() {
    return {.name = "pbrt",
            .readers = "pbrt-v3, layerlab, rs_pbrt, SORT",
            .holds = "RGB, Fourier series in azimuth, importance sampling",
            .endings = {".bsdf"},
            .content = FormatContent::sampled,
            .resolution = {"intervals of the cosine", 56, 4, 500, 112},
            .takes_colours = true,
            .accepted = {.plain = 0.02},
            .files = {{.colours = true, .write = write_pbrt}},
            .reader = pbrt_reader()};
}

}  // namespace miebrdf
