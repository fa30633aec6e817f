// SVG to PNG.
#pragma once

#include <string>

namespace miebrdf::plot {

/// @return  the bytes of a PNG file
/// @throws std::runtime_error  when the SVG cannot be drawn, with the renderer's reason
std::string rasterise(const std::string& svg, int width, int height);

/// False when the build has no renderer; then rasterise throws.
bool can_rasterise();

}  // namespace miebrdf::plot
