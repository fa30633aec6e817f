#include <miebrdf/brdf_source.h>

#include <fmt/format.h>

#include <algorithm>

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

    void evaluate(std::span<const Direction> directions, std::span<double> values) const override {
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
    return std::make_unique<PlainMix>(*this, weights);
}

std::size_t count_sharing_cosines(std::span<const Direction> directions) {
    const auto differs = [&](const Direction& d) {
        return d.mu_in != directions[0].mu_in || d.mu_out != directions[0].mu_out;
    };
    return static_cast<std::size_t>(std::find_if(directions.begin(), directions.end(), differs) -
                                    directions.begin());
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
