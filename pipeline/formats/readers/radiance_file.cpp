#include "pipeline/formats/readers/radiance_file.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include <miebrdf/error.h>

namespace miebrdf::exports {
namespace {

/// Numbers of a matrix or a full tree, whatever stands between them; seven digits, as Radiance has
/// them.
std::vector<float> parse_values(const char* text, std::size_t largest) {
    std::vector<float> values;
    const char* const end = text + std::char_traits<char>::length(text);
    values.reserve(std::min(largest, static_cast<std::size_t>(end - text) / 8));
    while (text < end) {
        if (std::string_view(" \t\r\n,{}").find(*text) != std::string_view::npos) {
            ++text;
            continue;
        }
        float value = 0.0F;
        const auto [after, error] = std::from_chars(text, end, value);
        if (error != std::errc() || !std::isfinite(value))
            throw InputError("radiance: ScatteringData has no number");
        values.push_back(value);
        if (values.size() > largest)
            throw InputError("radiance: ScatteringData has too many numbers");
        text = after;
    }
    return values;
}

}  // namespace

std::vector<float> radiance_block(const pugi::xml_node& layer, std::string_view wavelength,
                                  std::size_t largest) {
    for (const pugi::xml_node data : layer.children("WavelengthData")) {
        const pugi::xml_node part = data.child("WavelengthDataBlock");
        if (data.child_value("Wavelength") != wavelength) continue;
        if (part.child_value("WavelengthDataDirection") != std::string_view("Reflection Back"))
            continue;
        return parse_values(part.child_value("ScatteringData"), largest);
    }
    return {};
}

std::array<double, 3> srgb_of(double X, double Y, double Z) {
    // Inverse of the matrix of IEC 61966-2-1, to the digits of that standard.
    return {3.2406 * X - 1.5372 * Y - 0.4986 * Z, -0.9689 * X + 1.8758 * Y + 0.0415 * Z,
            0.0557 * X - 0.2040 * Y + 1.0570 * Z};
}

}  // namespace miebrdf::exports
