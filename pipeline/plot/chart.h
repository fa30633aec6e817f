// Curves over x and y axes, in one panel or several under each other.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <miebrdf/colour.h>
#include "pipeline/plot/axis.h"
#include "pipeline/plot/panel.h"
#include "pipeline/plot/picture.h"

namespace miebrdf::plot {

/// Draws panels under each other with their plot areas aligned; curves of the same label share a
/// colour and one legend entry at the top.
/// @throws std::invalid_argument  no panel, no curve, lengths that differ, or nothing to show
Picture draw_chart(const std::vector<Panel>& panels, const Caption& caption, double width = 460.0);

}  // namespace miebrdf::plot
