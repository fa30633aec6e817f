// Spectra to colours, as weights that a page multiplies.
#include <miebrdf/colour.h>

#include "pipeline/report/report_data.h"

namespace miebrdf::report {
namespace {

struct NamedIlluminant {
    Illuminant illuminant;
    const char* key;
    const char* name;
};
constexpr NamedIlluminant kIlluminants[] = {
    {Illuminant::d65, "d65", "Daylight D65"},
    {Illuminant::d50, "d50", "Warm daylight D50"},
    {Illuminant::a, "a", "Tungsten A"},
    {Illuminant::e, "e", "Equal energy E"},
};

/// The matrix from XYZ to linear sRGB, by rows: what it makes of each axis.
std::vector<double> srgb_matrix(const Viewing& viewing) {
    const LinearSrgb x = to_linear_srgb({1, 0, 0}, viewing), y = to_linear_srgb({0, 1, 0}, viewing),
                     z = to_linear_srgb({0, 0, 1}, viewing);
    return {x.red, y.red, z.red, x.green, y.green, z.green, x.blue, y.blue, z.blue};
}

}  // namespace

nlohmann::json colour_weights(const std::vector<double>& wavelength_nm) {
    if (!covers_the_visible(wavelength_nm)) return nullptr;
    nlohmann::json all = nlohmann::json::array();
    for (const NamedIlluminant& named : kIlluminants) {
        const Viewing viewing(named.illuminant);
        const ObserverWeights weights = observer_weights(wavelength_nm, viewing, Between::cubic);
        const Xyz white = white_point(viewing);
        all.push_back({{"key", named.key},
                       {"name", named.name},
                       {"x", weights.x},
                       {"y", weights.y},
                       {"z", weights.z},
                       {"white", {white.x, white.y, white.z}},
                       {"srgb", srgb_matrix(viewing)}});
    }
    return all;
}

}  // namespace miebrdf::report
