#include "tools/bench/method_styles.h"

#include <fmt/format.h>

#include <algorithm>

#include "pipeline/plot/colour_map.h"

namespace miebrdf::bench {

MethodStyles::MethodStyles(const std::vector<Measurement>& all) {
    for (const Measurement& m : all) {
        if (std::find(methods_.begin(), methods_.end(), m.method) == methods_.end()) {
            methods_.push_back(m.method);
        }
    }
}

MethodStyles::Style MethodStyles::of(const std::string& method) const {
    const auto found = std::find(methods_.begin(), methods_.end(), method);
    const auto i = static_cast<std::size_t>(found - methods_.begin());
    return {plot::curve_colour(static_cast<int>(i)), static_cast<int>(i) / plot::kCurveColours % 4};
}

std::string marker_path(int marker, double x, double y, double r) {
    switch (marker) {
        case 1:
            return fmt::format("M{:.1f} {:.1f}h{:.1f}v{:.1f}h-{:.1f}z", x - r, y - r, 2 * r, 2 * r,
                               2 * r);
        case 2:
            return fmt::format("M{:.1f} {:.1f}l{:.1f} {:.1f}h-{:.1f}z", x, y - 1.2 * r, 1.2 * r,
                               2.1 * r, 2.4 * r);
        case 3:
            return fmt::format("M{:.1f} {:.1f}l{:.1f} {:.1f}l-{:.1f} {:.1f}l-{:.1f} -{:.1f}z", x,
                               y - 1.4 * r, 1.4 * r, 1.4 * r, 1.4 * r, 1.4 * r, 1.4 * r, 1.4 * r);
        default:
            return fmt::format(
                "M{:.1f} {:.1f}a{:.1f} {:.1f} 0 1 0 {:.1f} 0a{:.1f} {:.1f} 0 1 0 -{:.1f} 0z", x - r,
                y, r, r, 2 * r, r, r, 2 * r);
    }
}

}  // namespace miebrdf::bench
