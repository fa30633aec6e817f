// The bar beside a colour map that says which colour is which value.
#pragma once

#include "pipeline/plot/axis.h"
#include "pipeline/plot/svg.h"

namespace miebrdf::plot {

/// Draws a vertical bar with ticks on its right and the label turned beside them.
void draw_colour_bar(SvgDrawing& drawing, const Axis& axis, Point corner, double width,
                     double height);

/// Colour of a value on the axis; values beyond its ends get the end colours, values that are not
/// finite or not on a logarithmic axis grey.
std::string colour_on(const Axis& axis, double value);

}  // namespace miebrdf::plot
