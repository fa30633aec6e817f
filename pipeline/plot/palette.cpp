#include "pipeline/plot/palette.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace miebrdf::plot {

std::string curve_colour(int index) {
    constexpr std::array<const char*, kCurveColours> colours = {
        "#000000", "#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9"};
    return colours[static_cast<std::size_t>(index) % colours.size()];
}

std::string curve_dash(int index) {
    constexpr std::array<const char*, 4> dashes = {"", "6 3", "2 2", "8 3 2 3"};
    return dashes[static_cast<std::size_t>(index / kCurveColours) % dashes.size()];
}

std::string map_colour(double position) {
    // Every tenth of viridis; linear between them is within 3 of 255 of the full table.
    constexpr double anchors[11][3] = {{68, 1, 84},    {72, 36, 117},  {65, 68, 135},
                                       {53, 95, 141},  {42, 120, 142}, {33, 145, 140},
                                       {34, 168, 132}, {68, 191, 112}, {122, 209, 81},
                                       {189, 223, 38}, {253, 231, 37}};
    if (!std::isfinite(position)) return kNoValueColour;
    const double place = 10.0 * std::round(255.0 * std::clamp(position, 0.0, 1.0)) / 255.0;
    const int below = std::min(9, static_cast<int>(place));
    const double t = place - below;
    const auto channel = [&](int c) {
        return static_cast<int>(
            std::lround((1.0 - t) * anchors[below][c] + t * anchors[below + 1][c]));
    };
    return fmt::format("#{:02x}{:02x}{:02x}", channel(0), channel(1), channel(2));
}

}  // namespace miebrdf::plot
