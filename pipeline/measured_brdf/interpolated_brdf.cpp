// From scattered measured directions to a BRDF at any direction.
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <tuple>

#include "pipeline/measured/reader.h"
#include "rte/math/kriging.h"

namespace miebrdf {
namespace {

constexpr std::size_t kFewestDirections = 12, kMostDirections = 6000;
/// Azimuths and cosines of a list agree to the digits that files have.
constexpr double kSameDirection = 1e-6;

/// Coordinates of a pair of directions that do not change with the azimuth of both or the side of
/// the plane of incidence: how far it is from the mirror direction and from retro-reflection (sum
/// and difference of the tangential vectors), and both cosines, which exchange the directions.
constexpr int kCoordinates = 4;
Eigen::RowVector4d coordinates(const Direction& d) {
    const double sin_in = std::sqrt(std::max(0.0, (1.0 - d.mu_in) * (1.0 + d.mu_in)));
    const double sin_out = std::sqrt(std::max(0.0, (1.0 - d.mu_out) * (1.0 + d.mu_out)));
    // Azimuth 0 is the mirror side: there the tangential vectors are opposite.
    const double product = -sin_in * sin_out * measured::cosine_of(d.azimuth_deg);
    const double squares = sin_in * sin_in + sin_out * sin_out;
    return {std::sqrt(std::max(0.0, squares + 2.0 * product)),
            std::sqrt(std::max(0.0, squares - 2.0 * product)), d.mu_in, d.mu_out};
}
Eigen::RowVector4d trend_at(const Eigen::RowVector4d& c) {
    return {1.0, c[2] + c[3], c[2] * c[3], c[0] * c[0]};
}

/// Wavelengths that were measured at the same directions.
struct MeasuredBlock {
    std::vector<Direction> directions;
    std::vector<std::size_t> channels;
    std::vector<std::vector<double>> logarithms;  ///< [channel of the block][direction]
};

class ScatteredBrdf final : public BrdfSource {
  public:
    ScatteredBrdf(std::vector<double> wavelength_nm, Provenance provenance)
        : wavelength_nm_(std::move(wavelength_nm)),
          channels_(channel_names(wavelength_nm_)),
          provenance_(std::move(provenance)) {}

    void add(std::vector<std::size_t> channels, math::Kriging kriging) {
        blocks_.push_back({std::move(channels), std::move(kriging)});
    }
    void set_accuracy(std::string accuracy) { provenance_.accuracy = std::move(accuracy); }

    const std::vector<std::string>& channels() const override { return channels_; }
    const std::vector<double>& wavelength_nm() const override { return wavelength_nm_; }
    const Provenance& provenance() const override { return provenance_; }

    void evaluate(std::span<const Direction> directions, std::span<double> values) const override {
        std::vector<Direction> storage;
        const auto valid = require_valid(directions, values.size(), channels_.size(), storage);
        for (std::size_t d = 0; d < valid.size(); ++d) {
            const Eigen::RowVector4d at = coordinates(valid[d]);
            for (const Block& block : blocks_) {
                const Eigen::RowVectorXd logs = block.kriging.evaluate(at, trend_at(at));
                for (std::size_t c = 0; c < block.channels.size(); ++c) {
                    values[d * channels_.size() + block.channels[c]] =
                        std::exp(logs[static_cast<Eigen::Index>(c)]);
                }
            }
        }
    }

  private:
    struct Block {
        std::vector<std::size_t> channels;
        math::Kriging kriging;
    };
    std::vector<double> wavelength_nm_;
    std::vector<std::string> channels_;
    Provenance provenance_;
    std::vector<Block> blocks_;
};

bool same(const Direction& a, const Direction& b) {
    return std::abs(a.mu_in - b.mu_in) <= kSameDirection &&
           std::abs(a.mu_out - b.mu_out) <= kSameDirection &&
           std::abs(a.azimuth_deg - b.azimuth_deg) <= kSameDirection;
}

/// Directions and logarithms of each wavelength, those of equal lists together.
std::vector<MeasuredBlock> blocks_of(const Measurements& list, std::vector<double>& wavelength_nm) {
    const auto refuse = [&](int line, const std::string& reason) {
        throw InputError(line > 0 ? fmt::format("{}:{}: {}", list.file, line, reason)
                                  : fmt::format("{}: {}", list.file, reason));
    };
    std::map<double, MeasuredBlock> spectra;
    for (const MeasuredValue& v : list.values) {
        const bool brdf = v.quantity == MeasuredQuantity::brdf;
        if (!brdf && v.quantity != MeasuredQuantity::reflectance_factor) continue;
        // Along the normal there is no azimuth.
        const double azimuth =
            std::isnan(v.azimuth_deg) && (v.mu_in == 1.0 || v.mu_out == 1.0) ? 0.0 : v.azimuth_deg;
        if (std::isnan(v.mu_in) || std::isnan(v.mu_out) || std::isnan(azimuth))
            refuse(v.line, "a BRDF needs mu_in, mu_out and the azimuth of every value");
        if (std::isnan(v.wavelength_nm))
            refuse(v.line, "no wavelength; give it with the option wavelength");
        if (!(v.value > 0.0)) {
            refuse(v.line, fmt::format("the value {} at {} nm; allowed: above 0, because its "
                                       "logarithm is interpolated. Leave it out of the file",
                                       v.value, v.wavelength_nm));
        }
        MeasuredBlock& block = spectra[v.wavelength_nm];
        block.directions.push_back({v.mu_in, v.mu_out, azimuth});
        if (block.logarithms.empty()) block.logarithms.emplace_back();
        block.logarithms.front().push_back(std::log(brdf ? v.value : v.value / std::numbers::pi));
    }
    if (spectra.empty()) refuse(0, "has no BRDF or reflectance factor at directions");
    std::vector<MeasuredBlock> blocks;
    for (auto& [nm, spectrum] : spectra) {
        const std::size_t count = spectrum.directions.size();
        if (count < kFewestDirections || count > kMostDirections) {
            refuse(0, fmt::format("{} directions at {} nm; allowed: {} to {}", count, nm,
                                  kFewestDirections, kMostDirections));
        }
        const std::size_t channel = wavelength_nm.size();
        wavelength_nm.push_back(nm);
        const bool joins =
            !blocks.empty() &&
            std::equal(spectrum.directions.begin(), spectrum.directions.end(),
                       blocks.back().directions.begin(), blocks.back().directions.end(), same);
        if (!joins) blocks.push_back({std::move(spectrum.directions), {}, {}});
        blocks.back().channels.push_back(channel);
        blocks.back().logarithms.push_back(std::move(spectrum.logarithms.front()));
    }
    return blocks;
}

math::ScatteredPoints points_of(const MeasuredBlock& block) {
    const auto n = static_cast<Eigen::Index>(block.directions.size());
    const auto columns = static_cast<Eigen::Index>(block.logarithms.size());
    math::ScatteredPoints points{Eigen::MatrixXd(n, kCoordinates), Eigen::MatrixXd(n, 4),
                                 Eigen::MatrixXd(n, columns)};
    for (Eigen::Index i = 0; i < n; ++i) {
        const Eigen::RowVector4d at = coordinates(block.directions[static_cast<std::size_t>(i)]);
        points.at.row(i) = at;
        points.trend.row(i) = trend_at(at);
        for (Eigen::Index c = 0; c < columns; ++c) {
            points.values(i, c) =
                block.logarithms[static_cast<std::size_t>(c)][static_cast<std::size_t>(i)];
        }
    }
    return points;
}

/// The largest directional albedo at some incidences from `least_mu_in` up.
double largest_albedo(const BrdfSource& source, double least_mu_in, const Control& control) {
    constexpr int kIncidences = 5, kZeniths = 24, kAzimuths = 24;
    std::vector<Direction> directions;
    for (int i = 0; i < kIncidences; ++i) {
        const double mu_in = least_mu_in + (1.0 - least_mu_in) * i / (kIncidences - 1);
        for (int o = 0; o < kZeniths; ++o) {
            // Equal parts of mu dmu.
            const double mu_out = std::sqrt((o + 0.5) / kZeniths);
            for (int a = 0; a < kAzimuths; ++a)
                directions.push_back({mu_in, mu_out, 180.0 * (a + 0.5) / kAzimuths});
        }
    }
    const std::vector<double> values = evaluate_all(source, directions, "albedo", control);
    const std::size_t channels = source.channels().size();
    const std::size_t block = std::size_t(kZeniths) * kAzimuths;
    double largest = 0.0;
    for (std::size_t i = 0; i < kIncidences; ++i) {
        for (std::size_t c = 0; c < channels; ++c) {
            double sum = 0.0;
            for (std::size_t k = 0; k < block; ++k) sum += values[(i * block + k) * channels + c];
            largest = std::max(largest, std::numbers::pi * sum / double(block));
        }
    }
    return largest;
}

}  // namespace

InterpolatedBrdf interpolated_brdf(const Measurements& measured, Provenance provenance,
                                   const Control& control) {
    if (measured.samples.size() > 1) {
        throw InputError(fmt::format("{}: has {} samples; choose one with the option column",
                                     measured.file, measured.samples.size()));
    }
    std::vector<double> wavelength_nm;
    const std::vector<MeasuredBlock> blocks = blocks_of(measured, wavelength_nm);
    provenance.sources.push_back("measured: " + measured.file);
    if (provenance.title.empty()) provenance.title = "measured: " + measured.file;
    const auto source = std::make_shared<ScatteredBrdf>(wavelength_nm, std::move(provenance));
    InterpolatedBrdf result;
    double residual = 0.0, left_out = 0.0;
    for (const MeasuredBlock& block : blocks) {
        const math::ScatteredPoints points = points_of(block);
        math::Kriging kriging(points, math::fitted_kernel(points));
        for (std::size_t i = 0; i < block.directions.size(); ++i) {
            const Direction& d = block.directions[i];
            result.least_mu_in = std::min(result.least_mu_in, d.mu_in);
            result.least_mu_out = std::min(result.least_mu_out, d.mu_out);
            for (std::size_t c = 0; c < block.channels.size(); ++c) {
                const auto row = static_cast<Eigen::Index>(i),
                           column = static_cast<Eigen::Index>(c);
                // Residuals are of logarithms: what is found is the value times exp(-difference).
                const double at = std::expm1(-kriging.residuals()(row, column));
                const double error = std::expm1(-kriging.leave_one_out()(row, column));
                residual += at * at;
                left_out += error * error;
                ++result.values;
                if (std::abs(error) <= std::abs(result.worst)) continue;
                result.worst = error;
                result.where = d;
            }
        }
        source->add(block.channels, std::move(kriging));
    }
    result.residual_rms = std::sqrt(residual / double(result.values));
    result.leave_one_out_rms = std::sqrt(left_out / double(result.values));
    result.largest_albedo = largest_albedo(*source, result.least_mu_in, control);
    if (result.largest_albedo > 1.0) {
        result.doubts.push_back(
            fmt::format("{}: the interpolated BRDF has a directional albedo of {:.4g}: its "
                        "calibration may be off, or directions near the horizon or the mirror "
                        "direction are missing",
                        measured.file, result.largest_albedo));
    }
    source->set_accuracy(fmt::format(
        "interpolated from {} measured values: {:.2g} % rms at them, {:.2g} % rms where each is "
        "left out; extrapolated below mu_in {:.3g} and mu_out {:.3g}",
        result.values, 100.0 * result.residual_rms, 100.0 * result.leave_one_out_rms,
        result.least_mu_in, result.least_mu_out));
    result.source = source;
    return result;
}

}  // namespace miebrdf
