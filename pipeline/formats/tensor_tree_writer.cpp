#include "pipeline/formats/tensor_tree_writer.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include <miebrdf/error.h>
#include "pipeline/formats/radiance_xml.h"
#include "pipeline/solve/vector_pairs.h"

namespace miebrdf::exports {
namespace {

/// Shirley and Chiu's area-preserving map of the unit square to the unit disk.
std::pair<double, double> square_to_disk(double x, double y) {
    const double a = 2 * x - 1, b = 2 * y - 1;
    double r = 0, phi = 0;
    if (a > -b) {
        if (a > b) {
            r = a;
            phi = std::numbers::pi / 4 * (b / a);
        } else {
            r = b;
            phi = std::numbers::pi / 4 * (2 - a / b);
        }
    } else if (a < b) {
        r = -a;
        phi = std::numbers::pi / 4 * (4 + b / a);
    } else {
        r = -b;
        phi = b != 0 ? std::numbers::pi / 4 * (6 - a / b) : 0;
    }
    return {r * std::cos(phi), r * std::sin(phi)};
}

}  // namespace

void write_radiance_tree(const RgbSource& source, int levels, std::ostream& out,
                         const RunControl& control) {
    if (!(levels >= 2 && levels <= 8)) {
        throw UsageError(
            fmt::format("radiance: {} levels are out of range; allowed: 2 to 8", levels));
    }
    const std::size_t n = std::size_t{1} << levels;
    // Incidence along the first axis, from grazing (0) to normal (1/2); its upper half is not used.
    // Seven digits are written: floats.
    RadianceBand bands[3] = {{"Visible", "ASTM E308 1931 Y.dsp", std::vector<float>(n * n * n / 2)},
                             {"CIE-u", "CIE 1976 u.dsp", std::vector<float>(n * n * n / 2)},
                             {"CIE-v", "CIE 1976 v.dsp", std::vector<float>(n * n * n / 2)}};
    for (std::size_t i = 0; i < n / 2; ++i) {
        const double sin_in = 1.0 - 2.0 * (static_cast<double>(i) + 0.5) / static_cast<double>(n);
        std::vector<Direction> directions;
        for (std::size_t x = 0; x < n; ++x) {
            for (std::size_t y = 0; y < n; ++y) {
                const auto [dx, dy] =
                    square_to_disk((static_cast<double>(x) + 0.5) / static_cast<double>(n),
                                   (static_cast<double>(y) + 0.5) / static_cast<double>(n));
                const double mu_out = std::sqrt(std::max(1e-12, 1 - dx * dx - dy * dy));
                directions.push_back(
                    {std::sqrt((1 - sin_in) * (1 + sin_in)), mu_out, std::atan2(dy, dx) / kDegree});
            }
        }
        const auto stage = fmt::format("incidence {} of {}", i + 1, n / 2);
        const std::vector<double> rgb = evaluate_all(source, directions, stage, control);
        for (std::size_t d = 0; d < directions.size(); ++d) {
            const auto [X, Y, Z] = xyz_of(&rgb[3 * d]);
            const double divisor = X + 15 * Y + 3 * Z;
            const std::size_t cell = i * n * n + d;
            bands[0].values[cell] = static_cast<float>(Y);
            bands[1].values[cell] = static_cast<float>(divisor > 0 ? 4 * X / divisor : 0.0);
            bands[2].values[cell] = static_cast<float>(divisor > 0 ? 9 * Y / divisor : 0.0);
        }
    }
    write_radiance_head(
        source,
        "<DataDefinition>\n<IncidentDataStructure>TensorTree3</IncidentDataStructure>\n</"
        "DataDefinition>\n",
        out);
    for (const RadianceBand& band : bands)
        write_radiance_band(band, "<AngleBasis>LBNL/Shirley-Chiu</AngleBasis>\n", 0, out);
    write_radiance_tail(out);
}

}  // namespace miebrdf::exports
