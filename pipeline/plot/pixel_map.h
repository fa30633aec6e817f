// Values as an image inside a chart: one pixel for each, in the colours of an axis.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "pipeline/plot/axis.h"
#include "pipeline/plot/svg.h"

namespace miebrdf::plot {

/// Pixels by index into a palette: the map of map_colour() in kPixelColours steps, grey for what is
/// no value, and nothing.
class PixelMap {
  public:
    static constexpr int kPixelColours = 254;
    static constexpr std::uint8_t kNoValue = 254, kNothing = 255;

    /// All pixels show nothing. @throws std::invalid_argument  for sides outside 1 to 8192
    PixelMap(int width, int height);

    /// Values beyond the ends of the axis get the end colours; what is not finite, or not on a
    /// logarithmic axis, is grey.
    void set(int x, int y, const Axis& axis, double value);
    std::uint8_t at(int x, int y) const { return pixels_[place(x, y)]; }

    /// The bytes of a PNG file (PNG specification: palette, 8 bits for a pixel).
    std::string png() const;
    /// Draws it into a rectangle of the page.
    void draw(SvgDrawing& drawing, Point corner, double width, double height) const;

  private:
    std::size_t place(int x, int y) const {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
               static_cast<std::size_t>(x);
    }

    int width_, height_;
    std::vector<std::uint8_t> pixels_;
};

}  // namespace miebrdf::plot
