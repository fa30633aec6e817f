#include "pipeline/plot/panel.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "pipeline/plot/colour_map.h"
#include "pipeline/plot/words.h"

namespace miebrdf::plot {

namespace {

/// Stretches of a curve between values that cannot be shown.
std::vector<std::vector<Point>> runs_of(const Placed& p, const Curve& curve) {
    std::vector<std::vector<Point>> runs(1);
    for (std::size_t i = 0; i < curve.x.size(); ++i) {
        const Point point = p.at(curve.x[i], curve.y[i]);
        if (std::isfinite(point.x) && std::isfinite(point.y)) {
            runs.back().push_back(point);
        } else if (!runs.back().empty()) {
            runs.emplace_back();
        }
    }
    return runs;
}

void clip_to_frame(SvgDrawing& drawing, const Placed& p, double margin) {
    drawing.begin_clip({p.left - margin, p.top - margin}, p.right - p.left + 2 * margin,
                       p.bottom - p.top + 2 * margin);
}

}  // namespace

void draw_axes(SvgDrawing& drawing, const Placed& p, bool with_x_labels) {
    const Stroke grid{"#e0e0e0", 0.8, {}};
    const Stroke edge{"#000000", 1.0, {}};
    for (const Tick& tick : p.x.ticks()) {
        const double x = p.at(tick.value, p.y.lowest()).x;
        if (!tick.label.empty()) drawing.line({x, p.top}, {x, p.bottom}, grid);
        drawing.line({x, p.bottom}, {x, p.bottom + (tick.label.empty() ? 3.0 : 5.0)}, edge);
        if (with_x_labels)
            drawing.text({x, p.bottom + 18}, tick.label, {kTickSize, Anchor::middle, 0, "#000000"});
    }
    for (const Tick& tick : p.y.ticks()) {
        const double y = p.at(p.x.lowest(), tick.value).y;
        if (!tick.label.empty()) drawing.line({p.left, y}, {p.right, y}, grid);
        drawing.line({p.left - (tick.label.empty() ? 3.0 : 5.0), y}, {p.left, y}, edge);
        drawing.text({p.left - 8, y + 4}, tick.label, {kTickSize, Anchor::end, 0, "#000000"});
    }
    drawing.frame({p.left, p.top}, p.right - p.left, p.bottom - p.top, edge);
    const double middle = 0.5 * (p.top + p.bottom);
    drawing.text(
        {16, middle}, p.y.label(),
        {fitting_size(p.y.label(), 13, p.bottom - p.top + 24), Anchor::middle, -90, "#000000"});
    if (with_x_labels) {
        drawing.text(
            {0.5 * (p.left + p.right), p.bottom + 38}, p.x.label(),
            {fitting_size(p.x.label(), 13, p.right - p.left), Anchor::middle, 0, "#000000"});
    }
}

void draw_curve(SvgDrawing& drawing, const Placed& p, const Curve& curve, int colour) {
    const auto runs = runs_of(p, curve);
    clip_to_frame(drawing, p, 1.0);  // half the width of a line that runs along the frame
    for (const auto& run : runs) {
        if (run.size() > 1 && curve.mark != Mark::points)
            drawing.polyline(run, curve_stroke(colour, 1.8, curve.shade));
    }
    drawing.end_clip();
    clip_to_frame(drawing, p, 4.0);
    for (const auto& run : runs) {
        // A lone point would be invisible as a line.
        if (curve.mark == Mark::line && run.size() != 1) continue;
        for (const Point& point : run)
            drawing.circle(point, 3.0, {curve_stroke(colour, 1.4, curve.shade).colour, 1.4, {}},
                           "#ffffff");
    }
    drawing.end_clip();
}

namespace {

constexpr double kNameSize = 10.0;

struct Box {
    double left, top, right, bottom;

    bool meets(const Box& other) const {
        return left < other.right && other.left < right && top < other.bottom && other.top < bottom;
    }
};

/// Where a name may stand near a point: left or right of it, lower or higher.
std::vector<Box> places_beside(const Point& point, const std::string& text) {
    const double width = SvgDrawing::text_width(text, kNameSize), height = kNameSize;
    std::vector<Box> places;
    for (const double rise : {0.1, 0.5, 1.0, -0.6, 1.6, 2.2, -1.2}) {  // heights above the point
        const double top = point.y - rise * height;
        places.push_back({point.x - 6 - width, top, point.x - 6, top + height});
        places.push_back({point.x + 6, top, point.x + 6 + width, top + height});
    }
    return places;
}

}  // namespace

void draw_names(SvgDrawing& drawing, const Placed& p) {
    std::vector<Box> taken, lines;
    const auto around = [](const Point& at, double half) -> Box {
        return {at.x - half, at.y - half, at.x + half, at.y + half};
    };
    for (const Curve& curve : p.panel.curves) {
        for (std::size_t i = 0; i < curve.x.size(); ++i) {
            const Point point = p.at(curve.x[i], curve.y[i]);
            if (curve.mark != Mark::line) taken.push_back(around(point, 4));
            if (i == 0 || curve.mark == Mark::points) continue;
            const Point last = p.at(curve.x[i - 1], curve.y[i - 1]);
            const double steps = std::hypot(point.x - last.x, point.y - last.y) / 3.0;
            for (double s = 0; s < steps; ++s)
                lines.push_back(around({last.x + (point.x - last.x) * s / steps,
                                        last.y + (point.y - last.y) * s / steps},
                                       1));
        }
    }
    for (const PointName& name : p.panel.names) {
        const auto is_free = [&](const Box& place, bool beside_lines) {
            const auto hides = [&](const Box& other) { return place.meets(other); };
            return place.left >= p.left && place.right <= p.right && place.top >= p.top &&
                   place.bottom <= p.bottom && std::none_of(taken.begin(), taken.end(), hides) &&
                   !(beside_lines && std::any_of(lines.begin(), lines.end(), hides));
        };
        const std::vector<Box> places = places_beside(p.at(name.x, name.y), name.text);
        auto place = places.end();
        for (const bool beside_lines : {true, false}) {
            if (place == places.end())
                place = std::find_if(places.begin(), places.end(),
                                     [&](const Box& b) { return is_free(b, beside_lines); });
        }
        if (place == places.end()) continue;
        drawing.text({place->left, place->bottom - 1}, name.text,
                     {kNameSize, Anchor::start, 0, curve_stroke(name.colour).colour});
        taken.push_back(*place);
    }
}

namespace {

constexpr double kLine = 18.0;         ///< from one line to the next
constexpr double kWrappedLine = 14.0;  ///< within an entry
constexpr double kSample = 24.0;       ///< length of the piece of curve
constexpr double kGap = 6.0;
constexpr double kBetween = 16.0;  ///< two entries
constexpr double kPatch = 14.0;
constexpr double kTextSize = 12.0;

double text_start(const LegendEntry& entry) {
    return kSample + kGap + (entry.swatch ? kPatch + kGap : 0.0);
}

double width_of(const LegendEntry& entry, const std::vector<std::string>& lines) {
    double widest = 0;
    for (const std::string& line : lines)
        widest = std::max(widest, SvgDrawing::text_width(line, kTextSize));
    return text_start(entry) + widest + kBetween;
}

/// @param base  left end of the text's base line, sample included
void draw_entry(SvgDrawing& drawing, const LegendEntry& entry,
                const std::vector<std::string>& lines, Point base) {
    const double middle = base.y - 4.5;
    if (entry.mark != Mark::points) {
        drawing.line({base.x, middle}, {base.x + kSample, middle},
                     curve_stroke(entry.colour, 1.8, entry.shade));
    }
    if (entry.mark != Mark::line) {
        drawing.circle({base.x + 0.5 * kSample, middle}, 3.0,
                       {curve_stroke(entry.colour, 1.4, entry.shade).colour, 1.4, {}}, "#ffffff");
    }
    if (entry.swatch) {
        const Point corner{base.x + kSample + kGap, base.y - 12};
        drawing.rectangle(corner, kPatch, kPatch, css_colour(*entry.swatch));
        drawing.frame(corner, kPatch, kPatch, {"#808080", 0.6, {}});
    }
    for (std::size_t i = 0; i < lines.size(); ++i) {
        drawing.text({base.x + text_start(entry), base.y + static_cast<double>(i) * kWrappedLine},
                     lines[i], {kTextSize, Anchor::start, 0, "#000000"});
    }
}

}  // namespace

Stroke curve_stroke(int index, double width, std::optional<double> shade) {
    // The light end of the map would be lost on white paper.
    constexpr double kLightest = 0.88;
    if (shade) return {map_colour(kLightest * *shade), width, {}};
    return {curve_colour(index), width, curve_dash(index)};
}

std::string css_colour(const LinearSrgb& colour) {
    const auto bytes = to_srgb8(colour);
    return fmt::format("#{:02x}{:02x}{:02x}", bytes[0], bytes[1], bytes[2]);
}

double draw_legend(SvgDrawing* drawing, const std::vector<LegendEntry>& entries, double left,
                   double right, double top) {
    if (entries.empty()) return 0.0;
    std::vector<std::vector<std::string>> lines;
    std::vector<double> widths;
    double widest = 0, total = 0;
    for (const LegendEntry& entry : entries) {
        lines.push_back(wrapped(entry.label, kTextSize, right - left - text_start(entry)));
        widths.push_back(width_of(entry, lines.back()));
        widest = std::max(widest, widths.back());
        total += widths.back();
    }
    // One line if there is room, else columns.
    const std::size_t count = entries.size();
    const bool one_line = total - kBetween <= right - left;
    const auto fitting =
        static_cast<std::size_t>(std::max(1.0, (right - left + kBetween) / widest));
    const std::size_t columns = one_line ? count : fitting;
    double y = top;
    for (std::size_t first = 0; first < count; first += columns) {
        double x = left;
        std::size_t most_lines = 1;
        for (std::size_t i = first; i < std::min(first + columns, count); ++i) {
            if (drawing != nullptr) draw_entry(*drawing, entries[i], lines[i], {x, y + kLine});
            x += one_line ? widths[i] : widest;
            most_lines = std::max(most_lines, lines[i].size());
        }
        y += kLine + kWrappedLine * static_cast<double>(most_lines - 1);
    }
    return y - top + 6.0;
}

}  // namespace miebrdf::plot
