#include "pipeline/plot/hemisphere.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "pipeline/plot/colour_map.h"
#include "pipeline/plot/svg.h"
#include "pipeline/plot/words.h"

namespace miebrdf::plot {
namespace {

constexpr double kWidth = 460.0;
constexpr double kRadius = 145.0;
constexpr double kSteepest_deg = 85.0;

struct Disk {
    Point centre;
    Point at(double zenith_deg, double azimuth_deg) const {
        const double azimuth = azimuth_deg * std::numbers::pi / 180;
        const double radius = kRadius * zenith_deg / 90;
        return {centre.x + radius * std::cos(azimuth), centre.y - radius * std::sin(azimuth)};
    }
};

void draw_marks(SvgDrawing& drawing, const Disk& disk, double incidence_deg) {
    for (const double zenith : {30.0, 60.0}) {
        drawing.circle(disk.centre, kRadius * zenith / 90, {"#ffffff", 0.6, "2 3"});
        const Point at = disk.at(zenith, 270);
        drawing.text({at.x + 3, at.y - 3}, fmt::format("{:g}\u00b0", zenith),
                     {10.5, Anchor::start, 0, "#ffffff"});
    }
    drawing.circle(disk.centre, kRadius, {"#000000", 1.2, {}});
    // White below black: visible on every colour of the map.
    const Point source = disk.at(incidence_deg, 180), mirror = disk.at(incidence_deg, 0);
    for (const Stroke& stroke : {Stroke{"#ffffff", 4.0, {}}, Stroke{"#000000", 1.6, {}}}) {
        drawing.circle(source, 5, stroke);
        drawing.line({mirror.x - 5, mirror.y - 5}, {mirror.x + 5, mirror.y + 5}, stroke);
        drawing.line({mirror.x - 5, mirror.y + 5}, {mirror.x + 5, mirror.y - 5}, stroke);
    }
    for (const int azimuth : {0, 90, 180, 270}) {
        const Point at = disk.at(90, azimuth);
        const Anchor anchor = azimuth == 0     ? Anchor::start
                              : azimuth == 180 ? Anchor::end
                                               : Anchor::middle;
        const double dx = azimuth == 0 ? 6 : azimuth == 180 ? -6 : 0;
        const double dy = azimuth == 90 ? -7 : azimuth == 270 ? 17 : 4;
        drawing.text({at.x + dx, at.y + dy}, fmt::format("{}\u00b0", azimuth),
                     {11.5, anchor, 0, "#000000"});
    }
}

void check(const HemisphereMap& map) {
    if (!(map.size >= 2 && map.size <= 4096 && map.size % 2 == 0)) {
        throw std::invalid_argument(
            fmt::format("a hemisphere of {} pixels; allowed: even, 2 to 4096", map.size));
    }
    const auto half = static_cast<std::size_t>(map.size) * static_cast<std::size_t>(map.size) / 2;
    if (map.value.size() != half) {
        throw std::invalid_argument(
            fmt::format("{} values for {} pixels of half a hemisphere", map.value.size(), half));
    }
}

/// Values that choose the ends of the colours: at the horizon a BRDF may fall or grow without
/// bound, and the rest of the picture would be of one colour.
std::vector<double> shown_values(const HemisphereMap& map) {
    std::vector<double> values;
    for (int y = 0; y < map.size / 2; ++y) {
        for (int x = 0; x < map.size; ++x) {
            const auto angles = pixel_angles(map.size, x, y);
            if (angles && angles->zenith_deg <= kSteepest_deg)
                values.push_back(map.value[static_cast<std::size_t>(y * map.size + x)]);
        }
    }
    return values;
}

}  // namespace

std::optional<ViewAngles> pixel_angles(int size, int x, int y) {
    const double half = 0.5 * size;
    const double right = (x + 0.5 - half) / half, up = (half - y - 0.5) / half;
    const double radius = std::hypot(right, up);
    if (!(radius < 1.0)) return std::nullopt;
    return ViewAngles{90.0 * radius, std::atan2(up, right) * 180 / std::numbers::pi};
}

PixelMap pixels_of(const HemisphereMap& map, const Axis& axis) {
    check(map);
    PixelMap pixels(map.size, map.size);
    for (int y = 0; y < map.size / 2; ++y) {
        for (int x = 0; x < map.size; ++x) {
            if (!pixel_angles(map.size, x, y)) continue;
            const double value = map.value[static_cast<std::size_t>(y * map.size + x)];
            pixels.set(x, y, axis, value);
            pixels.set(x, map.size - 1 - y, axis, value);
        }
    }
    return pixels;
}

Picture draw_hemisphere(const HemisphereMap& map, const Caption& caption) {
    check(map);
    const Axis axis({map.value_label, map.scale}, shown_values(map));
    const double top = draw_title(nullptr, caption.title, kWidth) + 20.0;
    const Disk disk{{46 + kRadius, top + kRadius}};
    SvgDrawing drawing(kWidth, std::ceil(disk.centre.y + kRadius + 48));
    draw_title(&drawing, caption.title, kWidth);
    pixels_of(map, axis).draw(drawing, {disk.centre.x - kRadius, disk.centre.y - kRadius},
                              2 * kRadius, 2 * kRadius);
    draw_marks(drawing, disk, map.incidence_deg);
    drawing.text({disk.centre.x, drawing.height() - 10},
                 fmt::format("incidence {:.4g}\u00b0:  \u25cb source  \u00d7 mirror direction",
                             map.incidence_deg),
                 {12, Anchor::middle, 0, "#000000"});
    draw_colour_bar(drawing, axis, {disk.centre.x + kRadius + 34, top}, 16, 2 * kRadius);
    return {drawing.document(caption.title, caption.command), drawing.width(), drawing.height()};
}

}  // namespace miebrdf::plot
