#include "pipeline/plot/chart.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>

#include "pipeline/plot/palette.h"

namespace miebrdf::plot {
namespace {

constexpr double kMarginRight = 18.0;
constexpr double kPanelGap = 22.0;
constexpr double kFooter = 48.0;
constexpr double kTitleSize = 14.0;
constexpr double kTickSize = 12.0;

void check(const std::vector<Panel>& panels) {
    if (panels.empty()) throw std::invalid_argument("a chart without panels");
    for (const Panel& panel : panels) {
        if (panel.curves.empty()) {
            throw std::invalid_argument(fmt::format("panel '{}' without curves", panel.y.label));
        }
        for (const Curve& curve : panel.curves) {
            if (curve.x.size() != curve.y.size()) {
                throw std::invalid_argument(fmt::format("curve '{}': {} x for {} y", curve.label,
                                                        curve.x.size(), curve.y.size()));
            }
        }
    }
}

/// Palette indices: what was asked for, else one for each new label in order.
class Colours {
  public:
    int of(const Curve& curve) {
        if (curve.colour) return *curve.colour;
        if (curve.label.empty()) return next_++;
        const auto [entry, is_new] = known_.try_emplace(curve.label, next_);
        if (is_new) ++next_;
        return entry->second;
    }

  private:
    std::map<std::string, int> known_;
    int next_ = 0;
};

/// A panel with its axes and its place on the page.
struct Placed {
    const Panel& panel;
    Axis x, y;
    double left, right, top, bottom;

    Point at(double xv, double yv) const {
        return {left + (right - left) * x.position(xv), bottom - (bottom - top) * y.position(yv)};
    }
};

std::vector<double> all_values(const Panel& panel, bool of_y) {
    std::vector<double> values;
    for (const Curve& curve : panel.curves) {
        const auto& list = of_y ? curve.y : curve.x;
        values.insert(values.end(), list.begin(), list.end());
    }
    return values;
}

/// x axes end where the data end; a rounded end would be empty paper.
AxisOptions tight(AxisOptions options, const std::vector<double>& values) {
    for (const double value : values) {
        if (!std::isfinite(value) || (options.scale == Scale::logarithmic && !(value > 0)))
            continue;
        if (!options.lowest || value < *options.lowest) options.lowest = value;
        if (!options.highest || value > *options.highest) options.highest = value;
    }
    if (options.lowest == options.highest) options.lowest = options.highest = std::nullopt;
    return options;
}

double widest_tick(const Axis& axis) {
    double width = 0;
    for (const Tick& tick : axis.ticks())
        width = std::max(width, SvgDrawing::text_width(tick.label, kTickSize));
    return width;
}

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
    drawing.text({16, middle}, p.y.label(), {13, Anchor::middle, -90, "#000000"});
    if (with_x_labels) {
        drawing.text({0.5 * (p.left + p.right), p.bottom + 38}, p.x.label(),
                     {13, Anchor::middle, 0, "#000000"});
    }
}

void draw_curve(SvgDrawing& drawing, const Placed& p, const Curve& curve, int colour) {
    std::vector<Point> run;
    const auto finish = [&] {
        if (run.size() > 1 && curve.mark != Mark::points)
            drawing.polyline(run, curve_stroke(colour));
        if (curve.mark != Mark::line ||
            run.size() == 1) {  // a lone point would be invisible as a line
            for (const Point& point : run) {
                drawing.circle(point, 3.0, {curve_colour(colour), 1.4, {}}, "#ffffff");
            }
        }
        run.clear();
    };
    for (std::size_t i = 0; i < curve.x.size(); ++i) {
        const Point point = p.at(curve.x[i], curve.y[i]);
        if (std::isfinite(point.x) && std::isfinite(point.y)) {
            run.push_back(point);
        } else {
            finish();
        }
    }
    finish();
}

std::vector<LegendEntry> legend_of(const std::vector<Panel>& panels, Colours& colours) {
    std::vector<LegendEntry> entries;
    for (const Panel& panel : panels) {
        for (const Curve& curve : panel.curves) {
            const int colour = colours.of(curve);
            const bool listed =
                std::any_of(entries.begin(), entries.end(),
                            [&](const LegendEntry& e) { return e.label == curve.label; });
            if (!curve.label.empty() && !listed)
                entries.push_back({curve.label, colour, curve.mark, curve.swatch});
        }
    }
    return entries;
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
    constexpr double kLine = 18.0, kSample = 24.0, kGap = 6.0, kBetween = 16.0;
    if (entries.empty()) return 0.0;
    const auto patch_of = [&](const LegendEntry& entry) {
        return entry.swatch ? 14.0 + kGap : 0.0;
    };
    const auto width_of = [&](const LegendEntry& entry) {
        return kSample + kGap + patch_of(entry) + SvgDrawing::text_width(entry.label, 12.0) +
               kBetween;
    };
    double widest = 0, total = 0;
    for (const LegendEntry& entry : entries) {
        widest = std::max(widest, width_of(entry));
        total += width_of(entry);
    }
    // One line if there is room, else columns.
    const int count = static_cast<int>(entries.size());
    const bool one_line = total - kBetween <= right - left;
    const int columns =
        one_line ? count : std::max(1, static_cast<int>((right - left + kBetween) / widest));
    double next = left;
    for (int i = 0; drawing != nullptr && i < count; ++i) {
        const LegendEntry& entry = entries[static_cast<std::size_t>(i)];
        const double x = one_line ? next : left + (i % columns) * widest;
        next += width_of(entry);
        const double y = top + kLine * (1 + i / columns);
        const double middle = y - 4.5;
        if (entry.mark != Mark::points) {
            drawing->line({x, middle}, {x + kSample, middle}, curve_stroke(entry.colour));
        }
        if (entry.mark != Mark::line) {
            drawing->circle({x + 0.5 * kSample, middle}, 3.0, {curve_colour(entry.colour), 1.4, {}},
                            "#ffffff");
        }
        if (entry.swatch) {
            const Point corner{x + kSample + kGap, y - 12};
            drawing->rectangle(corner, 14, 14, css_colour(*entry.swatch));
            drawing->frame(corner, 14, 14, {"#808080", 0.6, {}});
        }
        drawing->text({x + kSample + kGap + patch_of(entry), y}, entry.label,
                      {12.0, Anchor::start, 0, "#000000"});
    }
    return kLine * ((count + columns - 1) / columns) + 6.0;
}

Picture draw_chart(const std::vector<Panel>& panels, const Caption& caption, double width) {
    check(panels);
    Colours colours;
    const std::vector<LegendEntry> legend = legend_of(panels, colours);
    std::vector<Placed> placed;
    double left = 0;
    for (const Panel& panel : panels) {
        const auto x_values = all_values(panel, false);
        placed.push_back({panel, Axis(tight(panel.x, x_values), x_values),
                          Axis(panel.y, all_values(panel, true)), 0, width - kMarginRight, 0, 0});
        left = std::max(left, 36.0 + widest_tick(placed.back().y));
    }
    double y = caption.title.empty() ? 8.0 : 30.0;
    y += draw_legend(nullptr, legend, left, width - kMarginRight, y) + 6.0;
    for (Placed& p : placed) {
        p.left = left;
        p.top = y;
        p.bottom = y + p.panel.height;
        y = p.bottom + kPanelGap;
    }
    SvgDrawing drawing(width, std::ceil(y - kPanelGap + kFooter));
    drawing.text({0.5 * width, 22}, caption.title, {kTitleSize, Anchor::middle, 0, "#000000"});
    draw_legend(&drawing, legend, left, width - kMarginRight, caption.title.empty() ? 8.0 : 30.0);
    for (std::size_t i = 0; i < placed.size(); ++i) {
        const Placed& p = placed[i];
        draw_axes(drawing, p, i + 1 == placed.size());
        drawing.begin_clip({p.left - 4, p.top - 4}, p.right - p.left + 8, p.bottom - p.top + 8);
        for (const Curve& curve : p.panel.curves) draw_curve(drawing, p, curve, colours.of(curve));
        drawing.end_clip();
        drawing.text({p.left + 8, p.top + 17}, p.panel.note, {12.5, Anchor::start, 0, "#000000"});
    }
    return {drawing.document(caption.title, caption.command), drawing.width(), drawing.height()};
}

}  // namespace miebrdf::plot
