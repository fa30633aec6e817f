// Colours that stay apart for colour-blind readers and in grey print.
#pragma once

#include <string>

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

}  // namespace miebrdf::plot
