// Curves over x and y axes, in one panel or several under each other.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pipeline/colour.h"
#include "pipeline/plot/axis.h"
#include "pipeline/plot/picture.h"
#include "pipeline/plot/svg.h"

namespace miebrdf::plot {

enum class Mark { line, points, line_and_points };

struct Curve {
    std::string label;         ///< in the legend; empty: not listed
    std::vector<double> x, y;  ///< same length; values that are not finite break the line
    Mark mark = Mark::line;
    std::optional<int> colour = {};         ///< index into the palette; empty: next in order
    std::optional<LinearSrgb> swatch = {};  ///< a patch of this colour in the legend
};

struct Panel {
    AxisOptions x, y;
    std::vector<Curve> curves;
    double height = 230.0;  ///< of the plot area
    std::string note = {};  ///< in the upper left corner of the plot area
};

/// Draws panels under each other with their plot areas aligned; curves of the same label share a
/// colour and one legend entry at the top.
/// @throws std::invalid_argument  no panel, no curve, lengths that differ, or nothing to show
Picture draw_chart(const std::vector<Panel>& panels, const Caption& caption, double width = 460.0);

/// One entry of a legend and how it was marked in the chart.
struct LegendEntry {
    std::string label;
    int colour = 0;
    Mark mark = Mark::line;
    std::optional<LinearSrgb> swatch = {};
};

/// Lays entries out in lines between `left` and `right`; draws them unless `drawing` is null.
/// @return  height used
double draw_legend(SvgDrawing* drawing, const std::vector<LegendEntry>& entries, double left,
                   double right, double top);

/// A line in the colour and dash of the palette's i-th curve.
Stroke curve_stroke(int index, double width = 1.8);

/// The colour as "#rrggbb", encoded and clipped.
std::string css_colour(const LinearSrgb& colour);

}  // namespace miebrdf::plot
