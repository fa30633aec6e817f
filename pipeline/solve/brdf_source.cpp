#include <miebrdf/brdf_source.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include <miebrdf/error.h>
#include "pipeline/solve/parallel.h"

namespace miebrdf {
namespace {

/// Directions of one job: enough to make starting it cheap, few enough to share out evenly.
constexpr std::size_t kChunk = 4096;

/// Evaluates every channel, then sums.
class PlainMix : public ChannelMix {
  public:
    PlainMix(const BrdfSource& source, ColourWeights weights)
        : source_(source), weights_(std::move(weights)) {}

    void evaluate(std::span<const Direction> asked, std::span<double> values) const override {
        std::vector<Direction> storage;
        const auto directions = require_valid(asked, values.size(), 3, storage);
        const std::size_t channels = weights_.size();
        std::vector<double> spectra(directions.size() * channels);
        source_.evaluate(directions, spectra);
        std::fill(values.begin(), values.end(), 0.0);
        for (std::size_t i = 0; i < spectra.size(); ++i) {
            for (std::size_t c = 0; c < 3; ++c)
                values[i / channels * 3 + c] += weights_[i % channels][c] * spectra[i];
        }
    }

  private:
    const BrdfSource& source_;
    ColourWeights weights_;
};

}  // namespace

std::unique_ptr<ChannelMix> BrdfSource::mix(const ColourWeights& weights) const {
    require_weights(*this, weights);
    return std::make_unique<PlainMix>(*this, weights);
}

std::size_t count_sharing_cosines(std::span<const Direction> directions) {
    if (directions.empty()) return 0;
    const auto differs = [&](const Direction& d) {
        return d.mu_in != directions[0].mu_in || d.mu_out != directions[0].mu_out;
    };
    // The first shares its own, NaN or not.
    return static_cast<std::size_t>(
        std::find_if(directions.begin() + 1, directions.end(), differs) - directions.begin());
}

std::span<const Direction> require_valid(std::span<const Direction> directions, std::size_t values,
                                         std::size_t values_of_direction,
                                         std::vector<Direction>& storage) {
    const std::size_t needed = directions.size() * values_of_direction;
    if (!(values >= needed)) {
        throw UsageError("values", double(values),
                         fmt::format("room for {}, {} for each of the {} directions", needed,
                                     values_of_direction, directions.size()));
    }
    constexpr double kRounding = 1e-6;  // of unit vectors in single precision
    const auto require_cosine = [](const char* name, double mu) {
        if (!(mu > 0.0 && mu <= 1.0 + kRounding)) throw UsageError(name, mu, "(0, 1]");
    };
    bool any_beyond = false;
    for (const Direction& d : directions) {
        require_cosine("mu_in", d.mu_in);
        require_cosine("mu_out", d.mu_out);
        if (!std::isfinite(d.azimuth_deg))
            throw UsageError("azimuth_deg", d.azimuth_deg, "any finite number");
        any_beyond = any_beyond || d.mu_in > 1.0 || d.mu_out > 1.0;
    }
    if (!any_beyond) return directions;
    for (const Direction& d : directions)
        storage.push_back({std::min(d.mu_in, 1.0), std::min(d.mu_out, 1.0), d.azimuth_deg});
    return storage;
}

void require_weights(const BrdfSource& source, const ColourWeights& weights) {
    const std::size_t channels = source.channels().size();
    if (weights.size() != channels) {
        throw UsageError("weights", double(weights.size()),
                         fmt::format("{}, one for each channel", channels));
    }
}

std::vector<std::string> channel_names(const std::vector<double>& wavelength_nm) {
    std::vector<std::string> names;
    names.reserve(wavelength_nm.size());
    for (const double wavelength : wavelength_nm) names.push_back(fmt::format("{} nm", wavelength));
    return names;
}

std::vector<double> evaluate_all(const BrdfSource& source, std::span<const Direction> directions,
                                 const std::string& stage, const Control& control) {
    const std::size_t channels = source.channels().size();
    std::vector<double> values(directions.size() * channels);
    const std::size_t jobs = (directions.size() + kChunk - 1) / kChunk;
    run_parallel(stage, jobs, control, [&](std::size_t job) {
        const std::size_t first = job * kChunk;
        const std::size_t count = std::min(kChunk, directions.size() - first);
        source.evaluate(directions.subspan(first, count),
                        std::span(values).subspan(first * channels, count * channels));
    });
    return values;
}

void require_wavelengths(const BrdfSource& source, const std::string& format) {
    if (source.wavelength_nm().empty()) {
        throw UsageError(fmt::format("format '{}' holds spectra; this BRDF has the channels {}",
                                     format, fmt::join(source.channels(), ", ")));
    }
}

}  // namespace miebrdf
