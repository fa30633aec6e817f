#include "pipeline/plot/raster.h"

#include "pipeline/io/plugin.h"

namespace miebrdf::plot {

std::string rasterise(const std::string& svg, int width, int height) {
    static const auto draw = plugin_function<void(const std::string&, int, int, std::string&)>(
        "rsvg", "miebrdf_rasterise", "librsvg2-dev");
    std::string png;
    draw(svg, width, height, png);
    return png;
}

bool can_rasterise() { return has_plugin("rsvg"); }

}  // namespace miebrdf::plot
