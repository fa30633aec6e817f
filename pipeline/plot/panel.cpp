#include "pipeline/plot/panel.h"

#include <cmath>
#include <vector>

#include "pipeline/plot/palette.h"

namespace miebrdf::plot {
namespace {

/// Stretches of a curve between values that cannot be shown.
std::vector<std::vector<Point>> runs_of(const Placed& p, const Curve& curve) {
    std::vector<std::vector<Point>> runs(1);
    for (std::size_t i = 0; i < curve.x.size(); ++i) {
        const Point point = p.at(curve.x[i], curve.y[i]);
        if (std::isfinite(point.x) && std::isfinite(point.y)) {
            runs.back().push_back(point);
        } else if (!runs.back().empty()) {
            runs.emplace_back();
        }
    }
    return runs;
}

void clip_to_frame(SvgDrawing& drawing, const Placed& p, double margin) {
    drawing.begin_clip({p.left - margin, p.top - margin}, p.right - p.left + 2 * margin,
                       p.bottom - p.top + 2 * margin);
}

}  // namespace

void draw_axes(SvgDrawing& drawing, const Placed& p, bool with_x_labels) {
    const Stroke grid{"#e0e0e0", 0.8, {}};
    const Stroke edge{"#000000", 1.0, {}};
    for (const Tick& tick : p.x.ticks()) {
        const double x = p.at(tick.value, p.y.lowest()).x;
        if (!tick.label.empty()) drawing.line({x, p.top}, {x, p.bottom}, grid);
        drawing.line({x, p.bottom}, {x, p.bottom + (tick.label.empty() ? 3.0 : 5.0)}, edge);
        if (with_x_labels)
            drawing.text({x, p.bottom + 18}, tick.label, {kTickSize, Anchor::middle, 0, "#000000"});
    }
    for (const Tick& tick : p.y.ticks()) {
        const double y = p.at(p.x.lowest(), tick.value).y;
        if (!tick.label.empty()) drawing.line({p.left, y}, {p.right, y}, grid);
        drawing.line({p.left - (tick.label.empty() ? 3.0 : 5.0), y}, {p.left, y}, edge);
        drawing.text({p.left - 8, y + 4}, tick.label, {kTickSize, Anchor::end, 0, "#000000"});
    }
    drawing.frame({p.left, p.top}, p.right - p.left, p.bottom - p.top, edge);
    const double middle = 0.5 * (p.top + p.bottom);
    drawing.text({16, middle}, p.y.label(), {13, Anchor::middle, -90, "#000000"});
    if (with_x_labels) {
        drawing.text({0.5 * (p.left + p.right), p.bottom + 38}, p.x.label(),
                     {13, Anchor::middle, 0, "#000000"});
    }
}

void draw_curve(SvgDrawing& drawing, const Placed& p, const Curve& curve, int colour) {
    const auto runs = runs_of(p, curve);
    clip_to_frame(drawing, p, 1.0);  // half the width of a line that runs along the frame
    for (const auto& run : runs) {
        if (run.size() > 1 && curve.mark != Mark::points)
            drawing.polyline(run, curve_stroke(colour));
    }
    drawing.end_clip();
    clip_to_frame(drawing, p, 4.0);
    for (const auto& run : runs) {
        // A lone point would be invisible as a line.
        if (curve.mark == Mark::line && run.size() != 1) continue;
        for (const Point& point : run)
            drawing.circle(point, 3.0, {curve_colour(colour), 1.4, {}}, "#ffffff");
    }
    drawing.end_clip();
}

}  // namespace miebrdf::plot
