#include "pipeline/plot/pixel_map.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "pipeline/plot/colour_map.h"
#include "pipeline/plot/picture.h"

namespace miebrdf::plot {
namespace {

/// "#440154" as three bytes.
std::string bytes_of(const std::string& colour) {
    std::string bytes;
    for (int i = 0; i < 3; ++i) {
        const int value =
            std::stoi(colour.substr(1 + 2 * static_cast<std::size_t>(i), 2), nullptr, 16);
        bytes += static_cast<char>(value);
    }
    return bytes;
}

std::string palette() {
    std::string colours;
    for (int i = 0; i < PixelMap::kPixelColours; ++i)
        colours += bytes_of(map_colour(i / (PixelMap::kPixelColours - 1.0)));
    return colours + bytes_of(kNoValueColour) + bytes_of("#ffffff");
}

std::string deflated(const std::string& data) {
    uLongf size = compressBound(static_cast<uLong>(data.size()));
    std::string packed(size, '\0');
    const int failed = compress2(reinterpret_cast<Bytef*>(packed.data()), &size,
                                 reinterpret_cast<const Bytef*>(data.data()),
                                 static_cast<uLong>(data.size()), Z_BEST_COMPRESSION);
    if (failed != Z_OK) throw std::runtime_error("zlib could not compress an image");
    packed.resize(size);
    return packed;
}

}  // namespace

PixelMap::PixelMap(int width, int height) : width_(width), height_(height) {
    if (!(width >= 1 && width <= 8192 && height >= 1 && height <= 8192)) {
        throw std::invalid_argument(
            fmt::format("an image of {} x {} pixels; allowed: 1 to 8192 each", width, height));
    }
    pixels_.assign(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), kNothing);
}

void PixelMap::set(int x, int y, const Axis& axis, double value) {
    const double position = axis.position(value);
    pixels_[place(x, y)] = std::isfinite(position)
                               ? static_cast<std::uint8_t>(std::lround(
                                     std::clamp(position, 0.0, 1.0) * (kPixelColours - 1)))
                               : kNoValue;
}

std::string PixelMap::png() const {
    std::string header = big_endian(static_cast<std::uint32_t>(width_)) +
                         big_endian(static_cast<std::uint32_t>(height_));
    header += std::string("\x08\x03\x00\x00\x00", 5);  // 8 bits, palette, no interlacing
    std::string rows;
    for (int y = 0; y < height_; ++y) {
        rows += '\0';  // a row without a filter
        rows.append(reinterpret_cast<const char*>(pixels_.data() + place(0, y)),
                    static_cast<std::size_t>(width_));
    }
    return "\x89PNG\r\n\x1a\n" + png_chunk("IHDR", header) + png_chunk("PLTE", palette()) +
           png_chunk("tRNS", std::string(kNothing, '\xff') + '\0') +
           png_chunk("IDAT", deflated(rows)) + png_chunk("IEND", "");
}

void PixelMap::draw(SvgDrawing& drawing, Point corner, double width, double height) const {
    drawing.image(corner, width, height, png());
}

}  // namespace miebrdf::plot
