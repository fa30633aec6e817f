#include "pipeline/plot/lobe.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "pipeline/plot/colour_map.h"
#include "pipeline/plot/panel.h"
#include "pipeline/plot/svg.h"
#include "pipeline/plot/words.h"

namespace miebrdf::plot {

namespace {

constexpr double kWidth = 460.0;
constexpr double kRadius = 185.0;

void check(const std::vector<LobeCurve>& curves, const LobeOptions& options) {
    if (curves.empty()) throw std::invalid_argument("a lobe chart without curves");
    if (!(options.decades >= 1 && options.decades <= 12)) {
        throw std::invalid_argument(fmt::format("{} decades; allowed: 1 to 12", options.decades));
    }
    double largest = 0;
    for (const LobeCurve& curve : curves) {
        if (curve.angle_deg.size() != curve.value.size()) {
            throw std::invalid_argument(fmt::format("lobe '{}': {} values for {} angles",
                                                    curve.label, curve.value.size(),
                                                    curve.angle_deg.size()));
        }
        for (const double angle : curve.angle_deg) {
            if (!(std::abs(angle) <= 90)) {
                throw std::invalid_argument(fmt::format(
                    "lobe '{}': angle {} degrees; allowed: -90 to 90", curve.label, angle));
            }
        }
        for (const double value : curve.value) {
            if (std::isfinite(value)) largest = std::max(largest, value);
        }
    }
    if (!(largest > 0)) throw std::invalid_argument("a lobe chart needs a positive value");
}

std::vector<double> values_of(const std::vector<LobeCurve>& curves) {
    std::vector<double> values;
    for (const LobeCurve& curve : curves)
        values.insert(values.end(), curve.value.begin(), curve.value.end());
    return values;
}

/// The half disk's coordinates.
struct HalfDisk {
    Point centre;
    Point at(double angle_deg, double radius) const {
        const double angle = angle_deg * std::numbers::pi / 180;
        return {centre.x + kRadius * radius * std::sin(angle),
                centre.y - kRadius * radius * std::cos(angle)};
    }
};

void draw_grid(SvgDrawing& drawing, const HalfDisk& disk, const RadialScale& scale,
               const std::string& label) {
    const Stroke grid{"#d8d8d8", 0.8, {}};
    const auto arc = [&](double radius, const Stroke& stroke) {
        std::vector<Point> points;
        for (int angle = -90; angle <= 90; angle += 2) points.push_back(disk.at(angle, radius));
        drawing.polyline(points, stroke);
    };
    for (int angle = -90; angle <= 90; angle += 30) {
        drawing.line(disk.centre, disk.at(angle, 1.0), grid);
        const Point at = disk.at(angle, 1.03);
        const Anchor anchor = angle == 0 ? Anchor::middle : angle < 0 ? Anchor::end : Anchor::start;
        drawing.text({at.x, at.y + (std::abs(angle) == 90 ? 0 : 2)},
                     fmt::format("{}\u00b0", std::abs(angle)), {11.5, anchor, 0, "#000000"});
    }
    for (const Tick& tick : scale.circles()) {
        const double radius = scale.radius(tick.value);
        arc(radius, grid);
        for (const double side : {-90.0, 90.0}) {
            const Point at = disk.at(side, radius);
            drawing.line(at, {at.x, at.y + 4}, {"#000000", 1.0, {}});
            drawing.text({at.x, at.y + 16}, tick.label, {11.0, Anchor::middle, 0, "#000000"});
        }
    }
    arc(1.0, {"#909090", 1.0, {}});
    drawing.line(disk.at(-90, 1.0), disk.at(90, 1.0), {"#000000", 1.2, {}});
    drawing.text({disk.centre.x, disk.centre.y + 34}, label, {13, Anchor::middle, 0, "#000000"});
}

/// A ray from the rim to the surface with its arrow head.
void draw_incident_ray(SvgDrawing& drawing, const HalfDisk& disk, double incidence_deg,
                       const std::string& colour) {
    const Stroke stroke{colour, 1.2, "5 3"};
    drawing.line(disk.at(-incidence_deg, 1.0), disk.centre, stroke);
    const Point tip = disk.at(-incidence_deg, 0.42);
    const Point left = disk.at(-incidence_deg - 1.6, 0.475),
                right = disk.at(-incidence_deg + 1.6, 0.475);
    drawing.polygon({tip, left, right}, colour);
}

/// Distances of points that may be left out from the line that is drawn: nobody sees them.
constexpr double kInvisible = 0.03;

double distance_from_line(Point from, Point to, Point point) {
    const double dx = to.x - from.x, dy = to.y - from.y;
    const double length = std::hypot(dx, dy);
    if (length == 0.0) return std::hypot(point.x - from.x, point.y - from.y);
    const double along = ((point.x - from.x) * dx + (point.y - from.y) * dy) / length;
    if (along < 0.0 || along > length) return std::hypot(point.x - from.x, point.y - from.y);
    return std::abs((point.x - from.x) * dy - (point.y - from.y) * dx) / length;
}

/// Without the points that lie on the line between their neighbours: curves come in steps that are
/// fine enough for their narrowest feature, which most of them do not need.
std::vector<Point> bends_of(const std::vector<Point>& run) {
    std::vector<Point> kept{run.front()};
    std::size_t first = 1;  // of those left out since the last kept one
    for (std::size_t i = 1; i + 1 < run.size(); ++i) {
        const auto seen = [&](const Point& point) {
            return distance_from_line(kept.back(), run[i + 1], point) > kInvisible;
        };
        const auto begin = run.begin() + static_cast<std::ptrdiff_t>(first);
        if (std::none_of(begin, run.begin() + static_cast<std::ptrdiff_t>(i) + 1, seen)) continue;
        kept.push_back(run[i]);
        first = i + 1;
    }
    kept.push_back(run.back());
    return kept;
}

void draw_curve(SvgDrawing& drawing, const HalfDisk& disk, const RadialScale& scale,
                const LobeCurve& curve, int index) {
    std::vector<Point> run;
    for (std::size_t i = 0; i <= curve.angle_deg.size(); ++i) {
        if (i < curve.angle_deg.size() && std::isfinite(curve.value[i])) {
            run.push_back(disk.at(curve.angle_deg[i], scale.radius(curve.value[i])));
        } else {
            if (run.size() > 1)
                drawing.polyline(bends_of(run), curve_stroke(index, 1.8, curve.shade));
            run.clear();
        }
    }
}

}  // namespace

Picture draw_lobe(const std::vector<LobeCurve>& curves, const LobeOptions& options,
                  const Caption& caption) {
    check(curves, options);
    const auto values = values_of(curves);
    const double largest = *std::max_element(values.begin(), values.end(), [](double a, double b) {
        return !std::isfinite(b) ? false : !std::isfinite(a) || a < b;
    });
    const RadialScale scale(
        radial_options(options.value_label, options.logarithmic, options.decades, largest), values);

    const std::vector<LegendEntry> legend = legend_of_lines(curves);
    const double legend_top = draw_title(nullptr, caption.title, kWidth) - 2.0;
    const double top = legend_top + draw_legend(nullptr, legend, 24, kWidth - 16, legend_top) + 24;
    const HalfDisk disk{{0.5 * kWidth, top + kRadius}};
    SvgDrawing drawing(kWidth, std::ceil(disk.centre.y + 46));
    draw_title(&drawing, caption.title, kWidth);
    draw_legend(&drawing, legend, 24, kWidth - 16, legend_top);
    draw_grid(drawing, disk, scale, options.value_label);

    // One incidence for all is drawn neutrally, several in the colours of their curves.
    const bool common = std::all_of(curves.begin(), curves.end(), [&](const LobeCurve& c) {
        return c.incidence_deg == curves.front().incidence_deg;
    });
    for (std::size_t i = 0; i < (common ? 1 : curves.size()); ++i) {
        draw_incident_ray(
            drawing, disk, curves[i].incidence_deg,
            common ? "#707070" : curve_stroke(static_cast<int>(i), 1.8, curves[i].shade).colour);
    }
    for (std::size_t i = 0; i < curves.size(); ++i)
        draw_curve(drawing, disk, scale, curves[i], static_cast<int>(i));
    return {drawing.document(caption.title, caption.command), drawing.width(), drawing.height()};
}

}  // namespace miebrdf::plot
