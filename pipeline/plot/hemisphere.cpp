#include "pipeline/plot/hemisphere.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "pipeline/plot/colour_map.h"
#include "pipeline/plot/svg.h"

namespace miebrdf::plot {
namespace {

constexpr double kWidth = 460.0;
constexpr double kRadius = 145.0;

bool ascends(const std::vector<double>& edges, double lowest, double highest) {
    return edges.size() >= 2 && edges.front() >= lowest && edges.back() <= highest &&
           std::adjacent_find(edges.begin(), edges.end(),
                              [](double a, double b) { return !(a < b); }) == edges.end();
}

void check(const HemisphereMap& map) {
    if (!ascends(map.zenith_edges_deg, 0, 90)) {
        throw std::invalid_argument(
            "zenith edges of a hemisphere must ascend within 0 to 90 degrees");
    }
    const auto& azimuths = map.azimuth_edges_deg;
    if (!ascends(azimuths, -360, 360) || azimuths.back() - azimuths.front() > 360) {
        throw std::invalid_argument(
            "azimuth edges of a hemisphere must ascend and span at most 360 degrees");
    }
    const std::size_t cells = (map.zenith_edges_deg.size() - 1) * (azimuths.size() - 1);
    if (map.value.size() != cells) {
        throw std::invalid_argument(
            fmt::format("{} values for {} cells of the hemisphere", map.value.size(), cells));
    }
}

struct Disk {
    Point centre;
    Point at(double zenith_deg, double azimuth_deg) const {
        const double azimuth = azimuth_deg * std::numbers::pi / 180;
        const double radius = kRadius * zenith_deg / 90;
        return {centre.x + radius * std::cos(azimuth), centre.y - radius * std::sin(azimuth)};
    }
};

void draw_cells(SvgDrawing& drawing, const Disk& disk, const HemisphereMap& map, const Axis& axis) {
    const auto& azimuths = map.azimuth_edges_deg;
    const bool mirrored = azimuths.front() >= 0 && azimuths.back() <= 180;
    const std::size_t columns = azimuths.size() - 1;
    CellMap cells;
    for (std::size_t z = 0; z + 1 < map.zenith_edges_deg.size(); ++z) {
        const double* row = map.value.data() + z * columns;
        const double inner = kRadius * map.zenith_edges_deg[z] / 90;
        const double outer = kRadius * map.zenith_edges_deg[z + 1] / 90;
        for (std::size_t a = 0; a < columns;) {
            const std::string colour = colour_on(axis, row[a]);
            std::size_t end = a + 1;  // neighbours of one colour are one cell, up to half a ring
            while (end < columns && azimuths[end + 1] - azimuths[a] <= 180 &&
                   colour_on(axis, row[end]) == colour)
                ++end;
            cells.add_sector(disk.centre, inner, outer, azimuths[a], azimuths[end], colour);
            a = end;
        }
    }
    if (mirrored) drawing.begin_mirrored();
    cells.draw(drawing, Edges::overlapping);
    if (mirrored) drawing.end_mirrored(disk.centre.y);
}

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

}  // namespace

Picture draw_hemisphere(const HemisphereMap& map, const Caption& caption) {
    check(map);
    const Axis axis({map.value_label, map.scale}, map.value);
    const double top = caption.title.empty() ? 28.0 : 50.0;
    const Disk disk{{46 + kRadius, top + kRadius}};
    SvgDrawing drawing(kWidth, std::ceil(disk.centre.y + kRadius + 48));
    drawing.text({0.5 * kWidth, 22}, caption.title, {14, Anchor::middle, 0, "#000000"});
    draw_cells(drawing, disk, map, axis);
    draw_marks(drawing, disk, map.incidence_deg);
    drawing.text({disk.centre.x, drawing.height() - 10},
                 fmt::format("incidence {:g}\u00b0:  \u25cb source  \u00d7 mirror direction",
                             map.incidence_deg),
                 {12, Anchor::middle, 0, "#000000"});
    draw_colour_bar(drawing, axis, {disk.centre.x + kRadius + 34, top}, 16, 2 * kRadius);
    return {drawing.document(caption.title, caption.command), drawing.width(), drawing.height()};
}

}  // namespace miebrdf::plot
