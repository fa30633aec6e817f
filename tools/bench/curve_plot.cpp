#include "tools/bench/curve_plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "pipeline/io/markup.h"
#include "pipeline/plot/axis.h"
#include "pipeline/plot/colour_map.h"
#include "tools/bench/results.h"

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

namespace {

constexpr double kWidth = 1000, kHeight = 640, kLeft = 70, kRight = 730, kTop = 40, kBottom = 570;
// Beyond these points are drawn at the edge; their tooltips and the table have the numbers.
constexpr double kLowestError = 1e-17, kHighestError = 10, kShortestTime = 1e-6;

double drawn_error(const Measurement& m) {
    return std::clamp(m.error, kLowestError, kHighestError);
}
double upper_end(const Measurement& m) {
    return std::clamp(m.error + m.half_width, kLowestError, kHighestError);
}
double drawn_time(const Measurement& m) { return std::max(m.seconds, kShortestTime); }

/// Outline of a marker at (x, y) in SVG's path language, about 2 r wide.
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

/// Of letters of 8.5 units.
constexpr double kLetterWidth = 4.7, kLetterHeight = 9;
/// A label beyond the edge costs as much as one that covers this area.
constexpr double kOutside = 50;

struct Box {
    double left, top, right, bottom;
    double overlap(const Box& other) const {
        const double w = std::min(right, other.right) - std::max(left, other.left);
        const double h = std::min(bottom, other.bottom) - std::max(top, other.top);
        return w > 0 && h > 0 ? w * h : 0.0;
    }
};

/// Puts labels where they cover least of what is there already, near their point.
class LabelPlacer {
  public:
    explicit LabelPlacer(const Box& area) : area_(area) {}
    /// A point that labels should not cover.
    void block(double x, double y) { taken_.push_back({x - 4, y - 4, x + 4, y + 4}); }
    /// Where a text of so many characters goes; it is taken from now on.
    Box place(double x, double y, std::size_t characters);

  private:
    Box area_;
    std::vector<Box> taken_;
};

Box LabelPlacer::place(double x, double y, std::size_t characters) {
    const double w = kLetterWidth * static_cast<double>(characters) + 2, h = kLetterHeight;
    const std::array<std::pair<double, double>, 8> corners = {{{5, -h - 2},
                                                               {5, 2},
                                                               {-w - 5, -h - 2},
                                                               {-w - 5, 2},
                                                               {-w / 2, -h - 6},
                                                               {-w / 2, 6},
                                                               {7, -h / 2},
                                                               {-w - 7, -h / 2}}};
    Box best{};
    double least = INFINITY;
    for (const auto& [dx, dy] : corners) {
        const Box box{x + dx, y + dy, x + dx + w, y + dy + h};
        const bool is_outside =
            box.right > area_.right || box.left < area_.left || box.bottom > area_.bottom;
        double cost = is_outside ? kOutside : 0;
        for (const Box& other : taken_) cost += box.overlap(other);
        if (cost < least) {
            least = cost;
            best = box;
        }
    }
    taken_.push_back(best);
    return best;
}

/// Where values lie in the drawing.
struct Frame {
    plot::Axis time, error;

    double x(double seconds) const { return kLeft + time.position(seconds) * (kRight - kLeft); }
    double y(double value) const { return kBottom - error.position(value) * (kBottom - kTop); }
    std::pair<double, double> at(const Measurement& m) const {
        return {x(drawn_time(m)), y(drawn_error(m))};
    }
};

/// From a little below the lowest to a little above the highest value, so that no point lies on an
/// edge.
plot::Axis axis_around(const std::string& label, double lowest, double highest) {
    const double room =
        std::pow(10.0, std::max(0.15, 0.05 * (std::log10(highest) - std::log10(lowest))));
    return {{label, plot::Scale::logarithmic, lowest / room, highest * room}, {}};
}

Frame make_frame(const std::vector<Measurement>& drawn) {
    double t0 = INFINITY, t1 = 0, e0 = INFINITY, e1 = 0;
    for (const Measurement& m : drawn) {
        t0 = std::min(t0, drawn_time(m));
        t1 = std::max(t1, drawn_time(m));
        e0 = std::min(e0, drawn_error(m));
        e1 = std::max({e1, drawn_error(m), std::isnan(m.half_width) ? 0.0 : upper_end(m)});
    }
    return {axis_around("CPU time of one run", t0, t1),
            axis_around("largest relative error", e0, e1)};
}

std::string axes(const Frame& f) {
    std::string svg;
    for (const plot::Tick& tick : f.time.ticks()) {
        if (tick.label.empty()) continue;
        const double x = f.x(tick.value);
        svg += fmt::format(
            "<path class='grid' d='M{:.1f} {}V{}'/><text class='tick' x='{:.1f}' y='{}' "
            "text-anchor='middle'>{}</text>\n",
            x, kTop, kBottom, x, kBottom + 16, time_text(tick.value));
    }
    for (const plot::Tick& tick : f.error.ticks()) {
        if (tick.label.empty()) continue;
        const double y = f.y(tick.value);
        svg += fmt::format(
            "<path class='grid' d='M{} {:.1f}H{}'/><text class='tick' x='{}' y='{:.1f}' "
            "text-anchor='end'>{}</text>\n",
            kLeft, y, kRight, kLeft - 6, y + 4, tick.label);
    }
    svg += fmt::format("<text class='axis' x='{}' y='{}' text-anchor='middle'>{}</text>\n",
                       (kLeft + kRight) / 2, kBottom + 38, f.time.label());
    svg += fmt::format(
        "<text class='axis' transform='translate(18 {}) rotate(-90)' text-anchor='middle'>{}"
        "</text>\n",
        (kTop + kBottom) / 2, f.error.label());
    return svg;
}

std::string front_line(const std::vector<Measurement>& drawn, const Frame& f) {
    std::string path, rings;
    for (const std::size_t i : pareto_front(drawn)) {
        const auto [x, y] = f.at(drawn[i]);
        path += path.empty() ? fmt::format("M{:.1f} {:.1f}", x, y)
                             : fmt::format("H{:.1f}V{:.1f}", x, y);
        rings += fmt::format("<circle class='front' cx='{:.1f}' cy='{:.1f}' r='7'/>\n", x, y);
    }
    return fmt::format("<path class='front' d='{}'/>\n{}", path, rings);
}

// What the error would be at either end of the confidence interval; down to the axis if it holds 0.
std::string whisker(const Measurement& m, const Frame& f, const std::string& colour) {
    if (std::isnan(m.half_width)) return {};
    const double x = f.x(drawn_time(m)), top = f.y(upper_end(m));
    const double lower = m.error - m.half_width;
    const bool is_open = !(lower > kLowestError);
    const double bottom = is_open ? kBottom : std::min(kBottom, f.y(lower));
    return fmt::format(
        "<path class='whisker' d='M{0:.1f} {1:.1f}h6m-3 0V{2:.1f}{3}' stroke='{4}'/>\n", x - 3, top,
        bottom, is_open ? "" : "m-3 0h6", colour);
}

std::string tooltip(const Measurement& m) {
    const std::string sure =
        std::isnan(m.half_width) ? "" : fmt::format(" +- {:.1e} (95 %)", m.half_width);
    return escape_markup(fmt::format(
        "{} {}: error {:.2e}{}, {:.3g} s (spread {:.0f} %), memory {:.3g} MiB", m.method,
        m.parameter, m.error, sure, m.seconds, 100 * m.spread, m.memory / 1048576));
}

std::string legend_entry(const std::string& method, const MethodStyles::Style& style,
                         std::size_t row) {
    const double y = kTop + 12 + 19 * static_cast<double>(row);
    return fmt::format(
        "<g class='legend' data-method='{0}'><path d='{1}' fill='{2}'/><text x='{3}' "
        "y='{4:.1f}'>{0}</text></g>\n",
        escape_markup(method), marker_path(style.marker, kRight + 22, y, 4.5), style.colour,
        kRight + 34, y + 4);
}

std::string one_series(const std::string& method, const std::vector<Measurement>& drawn,
                       const Frame& f, const MethodStyles::Style& style, LabelPlacer& labels) {
    std::string line, points;
    for (const Measurement& m : drawn) {
        if (m.method != method) continue;
        const auto [x, y] = f.at(m);
        line += fmt::format("{}{:.1f} {:.1f}", line.empty() ? "M" : "L", x, y);
        const std::string& knob = m.parameter == "-" ? m.method : m.parameter;  // "-": it has none
        const Box box = labels.place(x, y, knob.size());
        points += whisker(m, f, style.colour);
        points += fmt::format(
            "<path class='point' d='{}' fill='{}'><title>{}</title></path><text class='knob' "
            "x='{:.1f}' y='{:.1f}' style='fill:{}'>{}</text>\n",
            marker_path(style.marker, x, y, 3.6), style.colour, tooltip(m), box.left + 1,
            box.bottom - 1.5, style.colour, escape_markup(knob));
    }
    return fmt::format(
        "<g class='series' data-method='{}'><path class='curve' d='{}' stroke='{}'/>\n{}</g>\n",
        escape_markup(method), line, style.colour, points);
}

constexpr char kStyleSheet[] =
    "text{font-family:Helvetica,Arial,sans-serif;font-size:12px;fill:#222}.tick{font-size:11px}"
    ".knob{font-size:8.5px}.title{font-size:15px;font-weight:bold}.grid{stroke:#e4e4e4;fill:none}"
    ".curve{fill:none;stroke-width:1.4}.whisker{fill:none;stroke-width:1;opacity:.7}.point{stroke:#"
    "fff;stroke-width:.6}"
    ".front{fill:none;stroke:#222;stroke-width:1}path.front{stroke-dasharray:2 3}";

}  // namespace

std::string curve_plot_svg(const std::string& title, const std::vector<Measurement>& points,
                           const MethodStyles& styles) {
    std::vector<Measurement> drawn;
    std::vector<std::string> methods, silent;
    for (const Measurement& m : points) {
        if (std::find(methods.begin(), methods.end(), m.method) == methods.end())
            methods.push_back(m.method);
        if (std::isfinite(m.error) && m.seconds > 0) {
            drawn.push_back(m);
        } else {
            silent.push_back(m.method + " " + m.parameter);
        }
    }
    std::string svg = fmt::format(
        "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 {0} {1}' width='{0}' height='{1}' "
        "role='img'>\n"
        "<style>{2}</style><rect width='{0}' height='{1}' fill='#fff'/>\n<text class='title' "
        "x='{3}' y='24'>{4}</text>\n",
        kWidth, kHeight, kStyleSheet, kLeft, escape_markup(title));
    if (!drawn.empty()) {
        const Frame frame = make_frame(drawn);
        svg += axes(frame) + front_line(drawn, frame);
        LabelPlacer labels({kLeft, kTop, kRight, kBottom});
        for (const Measurement& m : drawn) labels.block(frame.at(m).first, frame.at(m).second);
        for (const std::string& method : methods) {
            svg += one_series(method, drawn, frame, styles.of(method), labels);
        }
    }
    for (std::size_t i = 0; i < methods.size(); ++i) {
        svg += legend_entry(methods[i], styles.of(methods[i]), i);
    }
    if (!silent.empty()) {
        std::string list;
        for (const std::string& s : silent) list += (list.empty() ? "no answer: " : ", ") + s;
        svg += fmt::format("<text class='tick' x='{}' y='{}'>{}</text>\n", kLeft, kHeight - 6,
                           escape_markup(list));
    }
    return svg + "</svg>\n";
}

}  // namespace miebrdf::bench
