#include "pipeline/solve/rgb_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include <miebrdf/error.h>

namespace miebrdf {

RgbWeights nearest_wavelengths(const std::vector<double>& wavelength_nm) {
    constexpr std::array<double, 3> kWanted_nm = {620.0, 535.0, 480.0};
    RgbWeights weights;
    weights.weight.assign(wavelength_nm.size(), {0.0, 0.0, 0.0});
    weights.description = "single wavelengths";
    for (std::size_t c = 0; c < 3; ++c) {
        const auto nearest =
            std::min_element(wavelength_nm.begin(), wavelength_nm.end(), [&](double a, double b) {
                return std::abs(a - kWanted_nm[c]) < std::abs(b - kWanted_nm[c]);
            });
        weights.weight[static_cast<std::size_t>(nearest - wavelength_nm.begin())][c] = 1.0;
        weights.description += fmt::format("{} {} = {} nm", c == 0 ? ":" : ",", "RGB"[c], *nearest);
    }
    return weights;
}

RgbSource::RgbSource(const BrdfSource& source, RgbWeights weights)
    : source_(source), weights_(std::move(weights)) {
    if (weights_.weight.size() != source.wavelength_nm().size()) {
        throw UsageError(fmt::format("colour weights for {} wavelengths, but the BRDF has {}",
                                     weights_.weight.size(), source.wavelength_nm().size()));
    }
    mix_ = source.mix(weights_.weight);
}

void RgbSource::evaluate(std::span<const Direction> directions, std::span<double> values) const {
    mix_->evaluate(directions, values);
}

}  // namespace miebrdf
