#include "pipeline/formats/common/rgb_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include <miebrdf/colour.h>
#include <miebrdf/error.h>
#include "pipeline/formats/common/finite_source.h"

namespace miebrdf {
namespace {

/// Colour is linear in the spectrum: the colour of a unit of each wavelength is its weight.
RgbWeights cie_weights(const std::vector<double>& wavelength_nm) {
    if (!std::is_sorted(wavelength_nm.begin(), wavelength_nm.end(), std::less_equal<>())) {
        throw UsageError("colours of the CIE observer need wavelengths in ascending order");
    }
    const ObserverWeights observer = observer_weights(wavelength_nm, Illuminant::d65);
    RgbWeights weights;
    for (std::size_t w = 0; w < wavelength_nm.size(); ++w) {
        const LinearSrgb colour =
            to_linear_srgb({observer.x[w], observer.y[w], observer.z[w]}, Illuminant::d65);
        weights.weight.push_back({colour.red, colour.green, colour.blue});
    }
    weights.description =
        "linear sRGB primaries (IEC 61966-2-1), illuminant D65, CIE 1931 2 degree observer";
    return weights;
}

}  // namespace

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

RgbWeights rgb_weights(const std::string& mode, const std::vector<double>& wavelength_nm) {
    if (mode == "cie") return cie_weights(wavelength_nm);
    if (mode == "wavelengths") return nearest_wavelengths(wavelength_nm);
    if (mode != "auto")
        throw UsageError(fmt::format("unknown colour '{}'; allowed: cie, wavelengths, auto", mode));
    return covers_the_visible(wavelength_nm) ? cie_weights(wavelength_nm)
                                             : nearest_wavelengths(wavelength_nm);
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
    require_finite(directions, values, channels_.size());
}

}  // namespace miebrdf
