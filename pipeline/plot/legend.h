// Which curve is which, and how curves look.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pipeline/colour/colour.h"
#include "pipeline/plot/svg.h"

namespace miebrdf::plot {

enum class Mark { line, points, line_and_points };

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
