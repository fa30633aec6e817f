// Words on a chart that must not leave the page: titles and labels in as many lines as they need.
#pragma once

#include <string>
#include <vector>

#include "pipeline/plot/svg.h"

namespace miebrdf::plot {

/// Breaks a text at blanks into lines that are at most `width` wide; one word that is wider alone
/// stays whole.
std::vector<std::string> wrapped(const std::string& text, double size, double width);

/// Draws the title of a chart in lines of about the same length, or nothing where `drawing` is
/// null. @return  where the rest of the chart may begin, from the top of the page
double draw_title(SvgDrawing* drawing, const std::string& title, double page_width);

/// The size in which a text is at most `width` wide: `size`, or a smaller one.
double fitting_size(const std::string& text, double size, double width);

}  // namespace miebrdf::plot
