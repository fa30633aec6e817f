#include "pipeline/plot/chart.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>

#include "pipeline/plot/panel.h"
#include "pipeline/plot/words.h"

namespace miebrdf::plot {
namespace {

constexpr double kMarginRight = 18.0;
constexpr double kPanelGap = 22.0;
constexpr double kFooter = 48.0;

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

std::vector<LegendEntry> legend_of(const std::vector<Panel>& panels, Colours& colours) {
    std::vector<LegendEntry> entries;
    for (const Panel& panel : panels) {
        for (const Curve& curve : panel.curves) {
            const int colour = colours.of(curve);
            const bool listed =
                std::any_of(entries.begin(), entries.end(),
                            [&](const LegendEntry& e) { return e.label == curve.label; });
            if (!curve.label.empty() && !listed)
                entries.push_back({curve.label, colour, curve.mark, curve.swatch, curve.shade});
        }
    }
    return entries;
}

/// Whether no curve runs through the place of the note, in the upper or the lower left corner.
bool note_is_free(const Placed& p, bool above) {
    const double width = SvgDrawing::text_width(p.panel.note, 12.5) + 16, height = 24;
    for (const Curve& curve : p.panel.curves) {
        for (std::size_t i = 0; i < curve.x.size(); ++i) {
            const Point at = p.at(curve.x[i], curve.y[i]);
            const double off = above ? at.y - p.top : p.bottom - at.y;
            if (at.x - p.left <= width && off <= height) return false;
        }
    }
    return true;
}

}  // namespace

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
    const double legend_top = draw_title(nullptr, caption.title, width);
    double y = legend_top;
    y += draw_legend(nullptr, legend, left, width - kMarginRight, y) + 6.0;
    for (Placed& p : placed) {
        p.left = left;
        p.top = y;
        p.bottom = y + p.panel.height;
        y = p.bottom + kPanelGap;
    }
    SvgDrawing drawing(width, std::ceil(y - kPanelGap + kFooter));
    draw_title(&drawing, caption.title, width);
    draw_legend(&drawing, legend, left, width - kMarginRight, legend_top);
    for (std::size_t i = 0; i < placed.size(); ++i) {
        const Placed& p = placed[i];
        draw_axes(drawing, p, i + 1 == placed.size());
        for (const Curve& curve : p.panel.curves) draw_curve(drawing, p, curve, colours.of(curve));
        draw_names(drawing, p);
        drawing.text({p.left + 8,
                      note_is_free(p, true) || !note_is_free(p, false) ? p.top + 17 : p.bottom - 9},
                     p.panel.note, {12.5, Anchor::start, 0, "#000000"});
    }
    return {drawing.document(caption.title, caption.command), drawing.width(), drawing.height()};
}

}  // namespace miebrdf::plot
