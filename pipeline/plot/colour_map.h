// Colours that stay apart for colour-blind readers and in grey print.
#pragma once

#include <string>

#include "pipeline/plot/axis.h"
#include "pipeline/plot/svg.h"

namespace miebrdf::plot {

inline constexpr int kCurveColours = 7;

/// Colour of the i-th curve as "#rrggbb": black first, then Okabe & Ito's set without its yellow,
/// which is lost on white paper; repeats after 7.
std::string curve_colour(int index);

/// Dash pattern of the i-th curve as an SVG stroke-dasharray; empty (solid) for the first 7.
std::string curve_dash(int index);

/// Sequential map "viridis" (van der Walt & Smith 2015, CC0): lightness rises evenly.
/// @param position  clamped to [0, 1]
std::string map_colour(double position);

/// The colour of values that are not finite.
inline constexpr const char* kNoValueColour = "#c8c8c8";

// The bar beside a colour map that says which colour is which value.

/// Draws a vertical bar with ticks on its right and the label turned beside them.
void draw_colour_bar(SvgDrawing& drawing, const Axis& axis, Point corner, double width,
                     double height);

/// Colour of a value on the axis; values beyond its ends get the end colours, values that are not
/// finite or not on a logarithmic axis grey.
std::string colour_on(const Axis& axis, double value);

}  // namespace miebrdf::plot
