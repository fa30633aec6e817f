#include "pipeline/plot/colour_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

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

void draw_colour_bar(SvgDrawing& drawing, const Axis& axis, Point corner, double width,
                     double height) {
    constexpr int kSteps = 128;
    for (int i = 0; i < kSteps; ++i) {
        const double top = corner.y + height * (kSteps - 1 - i) / kSteps;
        // Half a step of overlap, so that no seam shows between the steps.
        drawing.rectangle({corner.x, top}, width, height / kSteps * 1.5,
                          map_colour((i + 0.5) / kSteps));
    }
    const Stroke edge{"#000000", 1.0, {}};
    drawing.frame(corner, width, height, edge);
    for (const Tick& tick : axis.ticks()) {
        const double y = corner.y + height * (1.0 - axis.position(tick.value));
        const double right = corner.x + width;
        drawing.line({right, y}, {right + (tick.label.empty() ? 3.0 : 5.0), y}, edge);
        drawing.text({right + 8, y + 4}, tick.label, {11.5, Anchor::start, 0, "#000000"});
    }
    double widest = 0;
    for (const Tick& tick : axis.ticks())
        widest = std::max(widest, SvgDrawing::text_width(tick.label, 11.5));
    drawing.text({corner.x + width + widest + 16, corner.y + 0.5 * height}, axis.label(),
                 {12.5, Anchor::middle, 90, "#000000"});
}

std::string colour_on(const Axis& axis, double value) { return map_colour(axis.position(value)); }

}  // namespace miebrdf::plot
