#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "pipeline/plot/lobe.h"
#include "pipeline/plot/spectra.h"
#include "pipeline/plot/svg.h"
#include "pipeline/plot/words.h"

namespace miebrdf::plot {
namespace {

constexpr double kWidth = 460.0;
constexpr double kRadius = 165.0;

struct Disk {
    Point centre;
    Point at(double angle_deg, double radius) const {
        const double angle = angle_deg * std::numbers::pi / 180;
        return {centre.x + kRadius * radius * std::cos(angle),
                centre.y - kRadius * radius * std::sin(angle)};
    }
};

struct Range {
    double smallest = std::numeric_limits<double>::infinity();  ///< positive value
    double largest = 0.0;
};

Range phase_range(const std::vector<PhaseCurve>& curves) {
    Range range;
    for (const PhaseCurve& curve : curves) {
        if (curve.angle_deg.size() != curve.phase.size()) {
            throw std::invalid_argument(fmt::format("phase function '{}': {} values for {} angles",
                                                    curve.label, curve.phase.size(),
                                                    curve.angle_deg.size()));
        }
        for (const double p : curve.phase) {
            if (!(std::isfinite(p) && p > 0)) continue;
            range.smallest = std::min(range.smallest, p);
            range.largest = std::max(range.largest, p);
        }
    }
    if (!(range.largest > 0))
        throw std::invalid_argument("a phase function chart needs a positive value");
    return range;
}

/// Down to the power of ten below the smallest value, but never more than 12 decades.
int decades_of(const Range& range) {
    const double top = std::ceil(std::log10(range.largest) - 1e-9);
    const double bottom = std::floor(std::log10(range.smallest) + 1e-9);
    return static_cast<int>(std::clamp(top - bottom, 1.0, 12.0));
}

void draw_grid(SvgDrawing& drawing, const Disk& disk, const RadialScale& scale) {
    const Stroke grid{"#d8d8d8", 0.8, {}};
    for (const Tick& tick : scale.circles()) {
        const double radius = scale.radius(tick.value);
        drawing.circle(disk.centre, kRadius * radius, grid);
        if (radius < 0.2) continue;            // the curves are there
        const Point at = disk.at(75, radius);  // between two spokes, inside its circle
        drawing.text({at.x, at.y + 13}, tick.label, {11.0, Anchor::middle, 0, "#606060"});
    }
    drawing.circle(disk.centre, kRadius, {"#909090", 1.0, {}});
    for (int angle = 0; angle < 360; angle += 30) {
        drawing.line(disk.centre, disk.at(angle, 1.0), grid);
        const Point at = disk.at(angle, 1.09);
        drawing.text({at.x, at.y + 4}, fmt::format("{}\u00b0", angle <= 180 ? angle : 360 - angle),
                     {11.5, Anchor::middle, 0, "#000000"});
    }
    const Point from = disk.at(180, 1.45), to = disk.at(180, 1.23);
    drawing.line(from, to, {"#707070", 1.4, {}});
    drawing.polygon({to, {to.x - 8, to.y - 4}, {to.x - 8, to.y + 4}}, "#707070");
    drawing.text({from.x + 2, from.y - 8}, "light", {12, Anchor::start, 0, "#707070"});
}

}  // namespace

Picture draw_phase_polar(const std::vector<PhaseCurve>& curves, const Caption& caption,
                         int decades) {
    if (!(decades >= 0 && decades <= 12)) {
        throw std::invalid_argument(fmt::format("{} decades; allowed: 0 to 12", decades));
    }
    const Range range = phase_range(curves);
    if (decades == 0) decades = decades_of(range);
    const RadialScale scale(radial_options("phase function", true, decades, range.largest),
                            {range.largest});
    const std::vector<LegendEntry> legend = legend_of_lines(curves);
    const double legend_top = draw_title(nullptr, caption.title, kWidth) - 2.0;
    const double top = legend_top + draw_legend(nullptr, legend, 24, kWidth - 16, legend_top) + 28;
    const Disk disk{{0.5 * kWidth + 16, top + kRadius}};
    SvgDrawing drawing(kWidth, std::ceil(disk.centre.y + kRadius + 56));
    draw_title(&drawing, caption.title, kWidth);
    draw_legend(&drawing, legend, 24, kWidth - 16, legend_top);
    draw_grid(drawing, disk, scale);
    for (std::size_t i = 0; i < curves.size(); ++i) {
        for (const double side : {1.0, -1.0}) {  // the same above and below the axis
            std::vector<Point> points;
            for (std::size_t a = 0; a < curves[i].phase.size(); ++a) {
                points.push_back(
                    disk.at(side * curves[i].angle_deg[a], scale.radius(curves[i].phase[a])));
            }
            drawing.polyline(points, curve_stroke(static_cast<int>(i), 1.6, curves[i].shade));
        }
    }
    drawing.text({disk.centre.x, drawing.height() - 10},
                 "phase function (mean 1), logarithmic radius",
                 {12.5, Anchor::middle, 0, "#000000"});
    return {drawing.document(caption.title, caption.command), drawing.width(), drawing.height()};
}

}  // namespace miebrdf::plot
