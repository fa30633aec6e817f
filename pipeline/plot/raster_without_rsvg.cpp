#include "pipeline/plot/raster.h"

#include <stdexcept>

namespace miebrdf::plot {

std::string rasterise(const std::string&, int, int) {
    throw std::runtime_error("this build has no librsvg");
}

bool can_rasterise() { return false; }

}  // namespace miebrdf::plot
