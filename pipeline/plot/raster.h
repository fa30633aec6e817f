// SVG to PNG, by the plug-in rsvg.
#pragma once

#include <string>

namespace miebrdf::plot {

/// @return  the bytes of a PNG file
/// @throws UsageError          when the plug-in cannot be opened
/// @throws std::runtime_error  when the SVG cannot be drawn, with the renderer's reason
std::string rasterise(const std::string& svg, int width, int height);

/// Whether the plug-in can be opened.
bool can_rasterise();

}  // namespace miebrdf::plot
