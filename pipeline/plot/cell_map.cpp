#include "pipeline/plot/cell_map.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

namespace miebrdf::plot {
namespace {

/// With two decimals at most and no trailing zeros.
std::string brief(double value) {
    const double rounded = std::round(100 * value) / 100;
    return fmt::format("{:.6g}", rounded == 0 ? 0.0 : rounded);
}

Point on_circle(Point centre, double radius, double angle_deg) {
    const double angle = angle_deg * std::numbers::pi / 180;
    return {centre.x + radius * std::cos(angle), centre.y - radius * std::sin(angle)};
}

/// An arc to `end`; sweep 1 is clockwise on the page.
std::string arc(double radius, double span_deg, int sweep, Point end) {
    return fmt::format("A{0} {0} 0 {1} {2} {3} {4}", brief(radius), span_deg > 180 ? 1 : 0, sweep,
                       brief(end.x), brief(end.y));
}

}  // namespace

void CellMap::add_rectangle(Point corner, double width, double height, const std::string& colour) {
    // Rounded sides, not rounded widths: neighbours must meet.
    const auto rounded = [](double value) { return std::round(100 * value) / 100; };
    const double x = rounded(corner.x), w = rounded(corner.x + width) - x;
    const double y = rounded(corner.y), h = rounded(corner.y + height) - y;
    paths_[colour] +=
        fmt::format("M{} {}h{}v{}h{}z", brief(x), brief(y), brief(w), brief(h), brief(-w));
}

void CellMap::add_sector(Point centre, double inner, double outer, double first_deg,
                         double last_deg, const std::string& colour) {
    const double span = last_deg - first_deg;
    const Point start = on_circle(centre, outer, first_deg),
                end = on_circle(centre, outer, last_deg);
    std::string path =
        fmt::format("M{} {}", brief(start.x), brief(start.y)) + arc(outer, span, 0, end);
    const Point back = on_circle(centre, inner, last_deg);
    path += fmt::format("L{} {}", brief(back.x), brief(back.y));
    if (inner > 0) path += arc(inner, span, 1, on_circle(centre, inner, first_deg));
    paths_[colour] += path + "z";
}

void CellMap::draw(SvgDrawing& drawing, Edges edges) const {
    for (const auto& [colour, path] : paths_) drawing.path(path, colour, edges);
}

}  // namespace miebrdf::plot
