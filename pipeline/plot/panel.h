// One plot area of a chart: its axes, what is drawn between them, and the legend of its curves.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <miebrdf/colour.h>
#include "pipeline/plot/axis.h"
#include "pipeline/plot/svg.h"

namespace miebrdf::plot {

enum class Mark { line, points, line_and_points };

/// One entry of a legend and how it was marked in the chart.
struct LegendEntry {
    std::string label;
    int colour = 0;
    Mark mark = Mark::line;
    std::optional<LinearSrgb> swatch = {};
    std::optional<double> shade = {};  ///< as of a curve
};

/// Entries of the curves that have a label, as lines in the order of the palette.
template <typename Curve>
std::vector<LegendEntry> legend_of_lines(const std::vector<Curve>& curves) {
    std::vector<LegendEntry> legend;
    for (std::size_t i = 0; i < curves.size(); ++i) {
        const Curve& curve = curves[i];
        if (!curve.label.empty())
            legend.push_back({curve.label, static_cast<int>(i), Mark::line, {}, curve.shade});
    }
    return legend;
}

/// Lays entries out in lines between `left` and `right`; draws them unless `drawing` is null.
/// @return  height used
double draw_legend(SvgDrawing* drawing, const std::vector<LegendEntry>& entries, double left,
                   double right, double top);

/// A line in the colour and dash of the palette's i-th curve, or of a member of a family.
Stroke curve_stroke(int index, double width = 1.8, std::optional<double> shade = {});

/// The colour as "#rrggbb", encoded and clipped.
std::string css_colour(const LinearSrgb& colour);

struct Curve {
    std::string label;         ///< in the legend; empty: not listed
    std::vector<double> x, y;  ///< same length; values that are not finite break the line
    Mark mark = Mark::line;
    std::optional<int> colour = {};         ///< index into the palette; empty: next in order
    std::optional<LinearSrgb> swatch = {};  ///< a patch of this colour in the legend
    /// Place among the members of a family: 0 for the first, 1 for the last; from dark to light
    /// instead of the palette.
    std::optional<double> shade = {};
};

/// The words beside a point.
struct PointName {
    double x = 0.0, y = 0.0;
    std::string text;
    int colour = 0;  ///< index into the palette
};

struct Panel {
    AxisOptions x, y;
    std::vector<Curve> curves;
    double height = 230.0;  ///< of the plot area
    std::string note = {};  ///< in the upper left corner of the plot area
    /// The first ones come first: those that would cover a point, a line or an earlier name are
    /// left out.
    std::vector<PointName> names = {};
};

inline constexpr double kTickSize = 12.0;  ///< of the numbers at an axis

/// A panel with its axes and its place on the page.
struct Placed {
    const Panel& panel;
    Axis x, y;
    double left, right, top, bottom;

    Point at(double xv, double yv) const {
        return {left + (right - left) * x.position(xv), bottom - (bottom - top) * y.position(yv)};
    }
};

void draw_axes(SvgDrawing& drawing, const Placed& p, bool with_x_labels);

/// Lines end at the frame; marks on it are drawn whole.
void draw_curve(SvgDrawing& drawing, const Placed& p, const Curve& curve, int colour);

/// Panel::names, each on the first free side of its point.
void draw_names(SvgDrawing& drawing, const Placed& p);

}  // namespace miebrdf::plot
