#include "pipeline/formats/common/rgb_weights.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>

#include <miebrdf/colour.h>
#include <miebrdf/error.h>

namespace miebrdf::exports {
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

bool covers_the_visible(const std::vector<double>& wavelength_nm) {
    constexpr std::size_t kFewest = 8;
    constexpr double kBlue_nm = 430.0, kRed_nm = 650.0;
    return wavelength_nm.size() >= kFewest && wavelength_nm.front() <= kBlue_nm &&
           wavelength_nm.back() >= kRed_nm;
}

RgbWeights rgb_weights(const std::string& mode, const std::vector<double>& wavelength_nm) {
    if (mode == "cie") return cie_weights(wavelength_nm);
    if (mode == "wavelengths") return nearest_wavelengths(wavelength_nm);
    if (mode != "auto")
        throw UsageError(fmt::format("unknown colour '{}'; allowed: cie, wavelengths, auto", mode));
    return covers_the_visible(wavelength_nm) ? cie_weights(wavelength_nm)
                                             : nearest_wavelengths(wavelength_nm);
}

}  // namespace miebrdf::exports
