#include "pipeline/plot/svg.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cstdint>

#include "pipeline/io/markup.h"

namespace miebrdf::plot {
namespace {

/// Lowers the letters after "\u03b8_", "\u03c6_" and "Q_".
std::string with_subscripts(const std::string& text, double size) {
    std::string out;
    std::size_t done = 0;
    bool lowered = false;
    for (std::size_t at = text.find('_'); at != std::string::npos; at = text.find('_', at + 1)) {
        const auto follows = [&](const std::string& letter) {
            return at >= letter.size() &&
                   text.compare(at - letter.size(), letter.size(), letter) == 0;
        };
        if (!(follows("\u03b8") || follows("\u03c6") || follows("Q"))) continue;
        std::size_t end = at + 1;
        while (end < text.size() && std::isalpha(static_cast<unsigned char>(text[end]))) ++end;
        if (end == at + 1) continue;
        std::string before = text.substr(done, at - done);
        if (lowered && !before.empty() && before.front() == ' ') before.replace(0, 1, "\u00a0");
        // Text after a subscript goes up again, in an element of its own.
        out +=
            lowered ? fmt::format("<tspan dy=\"{:.1f}\">{}</tspan>", -0.25 * size, before) : before;
        out += fmt::format("<tspan dy=\"{:.1f}\" font-size=\"{:.1f}\">{}</tspan>", 0.25 * size,
                           0.75 * size, text.substr(at + 1, end - at - 1));
        lowered = true;
        done = end;
    }
    // Blanks at the ends of elements are dropped by some renderers.
    std::string rest = text.substr(done);
    if (lowered && !rest.empty() && rest.front() == ' ') rest.replace(0, 1, "\u00a0");
    return out + (lowered && !rest.empty()
                      ? fmt::format("<tspan dy=\"{:.1f}\">{}</tspan>", -0.25 * size, rest)
                      : rest);
}

std::string attributes(const Stroke& stroke) {
    std::string text =
        fmt::format("stroke=\"{}\" stroke-width=\"{:.2f}\"", stroke.colour, stroke.width);
    if (!stroke.dash.empty()) text += fmt::format(" stroke-dasharray=\"{}\"", stroke.dash);
    return text;
}

std::string list(const std::vector<Point>& points) {
    std::string text;
    for (const Point& p : points) text += fmt::format("{:.2f},{:.2f} ", p.x, p.y);
    if (!text.empty()) text.pop_back();
    return text;
}

}  // namespace

SvgDrawing::SvgDrawing(double width, double height) : width_(width), height_(height) {}

void SvgDrawing::line(Point from, Point to, const Stroke& stroke) {
    body_ += fmt::format("<line x1=\"{:.2f}\" y1=\"{:.2f}\" x2=\"{:.2f}\" y2=\"{:.2f}\" {}/>\n",
                         from.x, from.y, to.x, to.y, attributes(stroke));
}

void SvgDrawing::polyline(const std::vector<Point>& points, const Stroke& stroke) {
    body_ += fmt::format("<polyline points=\"{}\" fill=\"none\" stroke-linejoin=\"round\" {}/>\n",
                         list(points), attributes(stroke));
}

void SvgDrawing::polygon(const std::vector<Point>& points, const std::string& fill) {
    // A hairline of the same colour closes the seams that antialiasing leaves between neighbours.
    body_ +=
        fmt::format("<polygon points=\"{}\" fill=\"{}\" stroke=\"{}\" stroke-width=\"0.4\"/>\n",
                    list(points), fill, fill);
}

void SvgDrawing::rectangle(Point corner, double width, double height, const std::string& fill) {
    body_ += fmt::format(
        "<rect x=\"{:.2f}\" y=\"{:.2f}\" width=\"{:.2f}\" height=\"{:.2f}\" fill=\"{}\" "
        "shape-rendering=\"crispEdges\"/>\n",
        corner.x, corner.y, width, height, fill);
}

void SvgDrawing::image(Point corner, double width, double height, const std::string& png) {
    body_ += fmt::format(
        "<image x=\"{:.2f}\" y=\"{:.2f}\" width=\"{:.2f}\" height=\"{:.2f}\" "
        "preserveAspectRatio=\"none\" xlink:href=\"data:image/png;base64,{}\"/>\n",
        corner.x, corner.y, width, height, base64(png));
}

void SvgDrawing::frame(Point corner, double width, double height, const Stroke& stroke) {
    body_ += fmt::format(
        "<rect x=\"{:.2f}\" y=\"{:.2f}\" width=\"{:.2f}\" height=\"{:.2f}\" fill=\"none\" {}/>\n",
        corner.x, corner.y, width, height, attributes(stroke));
}

void SvgDrawing::circle(Point centre, double radius, const Stroke& stroke,
                        const std::string& fill) {
    body_ += fmt::format("<circle cx=\"{:.2f}\" cy=\"{:.2f}\" r=\"{:.2f}\" fill=\"{}\" {}/>\n",
                         centre.x, centre.y, radius, fill, attributes(stroke));
}

void SvgDrawing::text(Point at, const std::string& content, const TextStyle& style) {
    if (content.empty()) return;
    const char* anchors[] = {"start", "middle", "end"};
    std::string turn;
    if (style.rotation_deg != 0.0) {
        turn = fmt::format(" transform=\"rotate({:.2f} {:.2f} {:.2f})\"", style.rotation_deg, at.x,
                           at.y);
    }
    body_ += fmt::format(
        "<text xml:space=\"preserve\" x=\"{:.2f}\" y=\"{:.2f}\" font-size=\"{:.2f}\" "
        "text-anchor=\"{}\" "
        "fill=\"{}\"{}>{}</text>\n",
        at.x, at.y, style.size, anchors[static_cast<int>(style.anchor)], style.colour, turn,
        with_subscripts(escape_markup(content), style.size));
}

void SvgDrawing::begin_clip(Point corner, double width, double height) {
    const int id = clips_++;
    body_ += fmt::format(
        "<clipPath id=\"clip{}\"><rect x=\"{:.2f}\" y=\"{:.2f}\" width=\"{:.2f}\" "
        "height=\"{:.2f}\"/></clipPath>\n"
        "<g clip-path=\"url(#clip{})\">\n",
        id, corner.x, corner.y, width, height, id);
}

void SvgDrawing::end_clip() { body_ += "</g>\n"; }

std::string SvgDrawing::document(const std::string& title, const std::string& description) const {
    return fmt::format(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
        "<svg xmlns=\"http://www.w3.org/2000/svg\" "
        "xmlns:xlink=\"http://www.w3.org/1999/xlink\" width=\"{0:g}\" height=\"{1:g}\" viewBox=\"0 "
        "0 "
        "{0:g} {1:g}\" "
        "font-family=\"DejaVu Sans, Verdana, Helvetica, sans-serif\">\n"
        "<title>{2}</title>\n<desc>{3}</desc>\n"
        "<rect width=\"{0:g}\" height=\"{1:g}\" fill=\"#ffffff\"/>\n{4}</svg>\n",
        width_, height_, escape_markup(title), escape_markup(description), body_);
}

double SvgDrawing::text_width(const std::string& content, double size) {
    const auto letters = std::count_if(content.begin(), content.end(), [](char c) {
        return (static_cast<unsigned char>(c) & 0xc0) != 0x80;  // not the rest of a UTF-8 sequence
    });
    return 0.58 * size * static_cast<double>(letters);
}

}  // namespace miebrdf::plot
