// One plot area of a chart: its axes and what is drawn between them.
#pragma once

#include "pipeline/plot/axis.h"
#include "pipeline/plot/chart.h"
#include "pipeline/plot/svg.h"

namespace miebrdf::plot {

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

}  // namespace miebrdf::plot
