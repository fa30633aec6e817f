#include "tools/bench/curve_plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "pipeline/io/markup.h"
#include "tools/bench/label_placer.h"
#include "tools/bench/log_axis.h"
#include "tools/bench/results.h"

namespace miebrdf::bench {
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

struct Frame {
    LogAxis x, y;
    std::pair<double, double> at(const Measurement& m) const {
        return {x.position(drawn_time(m)), y.position(drawn_error(m))};
    }
};

Frame make_frame(const std::vector<Measurement>& drawn) {
    double t0 = INFINITY, t1 = 0, e0 = INFINITY, e1 = 0;
    for (const Measurement& m : drawn) {
        t0 = std::min(t0, drawn_time(m));
        t1 = std::max(t1, drawn_time(m));
        e0 = std::min(e0, drawn_error(m));
        e1 = std::max({e1, drawn_error(m), std::isnan(m.half_width) ? 0.0 : upper_end(m)});
    }
    return {LogAxis(t0, t1, kLeft, kRight), LogAxis(e0, e1, kBottom, kTop)};
}

std::string axes(const Frame& f) {
    std::string svg;
    for (const double seconds : f.x.ticks()) {
        const double x = f.x.position(seconds);
        svg += fmt::format(
            "<path class='grid' d='M{:.1f} {}V{}'/><text class='tick' x='{:.1f}' y='{}' "
            "text-anchor='middle'>{}</text>\n",
            x, kTop, kBottom, x, kBottom + 16, LogAxis::time_label(seconds));
    }
    for (const int decade : f.y.decades()) {
        const double y = f.y.position(std::pow(10.0, decade));
        svg += fmt::format(
            "<path class='grid' d='M{} {:.1f}H{}'/><text class='tick' x='{}' y='{:.1f}' "
            "text-anchor='end'>1e{}</text>\n",
            kLeft, y, kRight, kLeft - 6, y + 4, decade);
    }
    svg += fmt::format(
        "<text class='axis' x='{}' y='{}' text-anchor='middle'>CPU time of one run</text>\n",
        (kLeft + kRight) / 2, kBottom + 38);
    svg += fmt::format(
        "<text class='axis' transform='translate(18 {}) rotate(-90)' text-anchor='middle'>largest "
        "relative error</text>\n",
        (kTop + kBottom) / 2);
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
    const double x = f.x.position(drawn_time(m)), top = f.y.position(upper_end(m));
    const double lower = m.error - m.half_width;
    const bool is_open = !(lower > kLowestError);
    const double bottom = is_open ? kBottom : std::min(kBottom, f.y.position(lower));
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
