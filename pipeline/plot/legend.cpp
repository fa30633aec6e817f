#include "pipeline/plot/legend.h"

#include <fmt/format.h>

#include <algorithm>

#include "pipeline/plot/palette.h"

namespace miebrdf::plot {
namespace {

constexpr double kLine = 18.0;    ///< from one line to the next
constexpr double kSample = 24.0;  ///< length of the piece of curve
constexpr double kGap = 6.0;
constexpr double kBetween = 16.0;  ///< two entries
constexpr double kPatch = 14.0;
constexpr double kTextSize = 12.0;

double text_start(const LegendEntry& entry) {
    return kSample + kGap + (entry.swatch ? kPatch + kGap : 0.0);
}

double width_of(const LegendEntry& entry) {
    return text_start(entry) + SvgDrawing::text_width(entry.label, kTextSize) + kBetween;
}

/// @param base  left end of the text's base line, sample included
void draw_entry(SvgDrawing& drawing, const LegendEntry& entry, Point base) {
    const double middle = base.y - 4.5;
    if (entry.mark != Mark::points) {
        drawing.line({base.x, middle}, {base.x + kSample, middle}, curve_stroke(entry.colour));
    }
    if (entry.mark != Mark::line) {
        drawing.circle({base.x + 0.5 * kSample, middle}, 3.0, {curve_colour(entry.colour), 1.4, {}},
                       "#ffffff");
    }
    if (entry.swatch) {
        const Point corner{base.x + kSample + kGap, base.y - 12};
        drawing.rectangle(corner, kPatch, kPatch, css_colour(*entry.swatch));
        drawing.frame(corner, kPatch, kPatch, {"#808080", 0.6, {}});
    }
    drawing.text({base.x + text_start(entry), base.y}, entry.label,
                 {kTextSize, Anchor::start, 0, "#000000"});
}

}  // namespace

Stroke curve_stroke(int index, double width) {
    return {curve_colour(index), width, curve_dash(index)};
}

std::string css_colour(const LinearSrgb& colour) {
    const auto bytes = to_srgb8(colour);
    return fmt::format("#{:02x}{:02x}{:02x}", bytes[0], bytes[1], bytes[2]);
}

double draw_legend(SvgDrawing* drawing, const std::vector<LegendEntry>& entries, double left,
                   double right, double top) {
    if (entries.empty()) return 0.0;
    double widest = 0, total = 0;
    for (const LegendEntry& entry : entries) {
        widest = std::max(widest, width_of(entry));
        total += width_of(entry);
    }
    // One line if there is room, else columns.
    const auto count = static_cast<int>(entries.size());
    const bool one_line = total - kBetween <= right - left;
    int columns = one_line ? count : static_cast<int>((right - left + kBetween) / widest);
    if (columns < 1) columns = 1;
    double next = left;
    for (int i = 0; drawing != nullptr && i < count; ++i) {
        const LegendEntry& entry = entries[static_cast<std::size_t>(i)];
        const int row = i / columns;
        const double x = one_line ? next : left + (i % columns) * widest;
        next += width_of(entry);
        draw_entry(*drawing, entry, {x, top + kLine * (1 + row)});
    }
    const int rows = (count + columns - 1) / columns;
    return kLine * rows + 6.0;
}

}  // namespace miebrdf::plot
