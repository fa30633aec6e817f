// Curves over x and y axes, in one panel or several under each other.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pipeline/colour/colour.h"
#include "pipeline/plot/axis.h"
#include "pipeline/plot/legend.h"
#include "pipeline/plot/picture.h"

namespace miebrdf::plot {

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

}  // namespace miebrdf::plot
