#include "pipeline/plot/colour_bar.h"

#include <algorithm>

#include "pipeline/plot/palette.h"

namespace miebrdf::plot {

void draw_colour_bar(SvgDrawing& drawing, const Axis& axis, Point corner, double width,
                     double height) {
    constexpr int kSteps = 128;
    for (int i = 0; i < kSteps; ++i) {
        const double top = corner.y + height * (kSteps - 1 - i) / kSteps;
        // Half a step of overlap, so that no seam shows between the steps.
        drawing.rectangle({corner.x, top}, width, height / kSteps * 1.5,
                          map_colour((i + 0.5) / kSteps));
    }
    const Stroke edge{"#000000", 1.0, {}};
    drawing.frame(corner, width, height, edge);
    for (const Tick& tick : axis.ticks()) {
        const double y = corner.y + height * (1.0 - axis.position(tick.value));
        const double right = corner.x + width;
        drawing.line({right, y}, {right + (tick.label.empty() ? 3.0 : 5.0), y}, edge);
        drawing.text({right + 8, y + 4}, tick.label, {11.5, Anchor::start, 0, "#000000"});
    }
    double widest = 0;
    for (const Tick& tick : axis.ticks())
        widest = std::max(widest, SvgDrawing::text_width(tick.label, 11.5));
    drawing.text({corner.x + width + widest + 16, corner.y + 0.5 * height}, axis.label(),
                 {12.5, Anchor::middle, 90, "#000000"});
}

std::string colour_on(const Axis& axis, double value) { return map_colour(axis.position(value)); }

}  // namespace miebrdf::plot
