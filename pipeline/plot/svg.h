// A drawing in SVG: the few shapes that charts are made of, and nothing that reads files or fonts.
#pragma once

#include <string>
#include <vector>

namespace miebrdf::plot {

struct Point {
    double x = 0.0, y = 0.0;  ///< y downwards
};

enum class Anchor { start, middle, end };

struct TextStyle {
    double size = 13.0;
    Anchor anchor = Anchor::start;
    double rotation_deg = 0.0;  ///< clockwise, about the point
    std::string colour = "#000000";
};

struct Stroke {
    std::string colour = "#000000";
    double width = 1.0;
    std::string dash = {};  ///< SVG stroke-dasharray
};

/// Collects shapes in drawing order on a white page. Text is escaped; numbers are written with two
/// decimals, so that the same data give the same bytes.
class SvgDrawing {
  public:
    SvgDrawing(double width, double height);

    void line(Point from, Point to, const Stroke& stroke);
    void polyline(const std::vector<Point>& points, const Stroke& stroke);
    void polygon(const std::vector<Point>& points, const std::string& fill);
    void rectangle(Point corner, double width, double height, const std::string& fill);
    /// The bytes of a PNG file, scaled to a rectangle.
    void image(Point corner, double width, double height, const std::string& png);
    void frame(Point corner, double width, double height, const Stroke& stroke);
    void circle(Point centre, double radius, const Stroke& stroke,
                const std::string& fill = "none");
    /// Letters after "\u03b8_", "\u03c6_" and "Q_" become a subscript; nothing is drawn for "".
    void text(Point at, const std::string& content, const TextStyle& style = {});

    /// Everything between is cut off at a rectangle.
    void begin_clip(Point corner, double width, double height);
    void end_clip();

    /// The document; `description` (say, the command that made it) goes into its <desc>.
    std::string document(const std::string& title, const std::string& description) const;

    double width() const { return width_; }
    double height() const { return height_; }

    /// Width of a text, estimated from average letters of DejaVu Sans: within about 10 %.
    static double text_width(const std::string& content, double size);

  private:
    double width_, height_;
    int clips_ = 0;
    std::string body_;
};

}  // namespace miebrdf::plot
