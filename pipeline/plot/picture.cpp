#include "pipeline/plot/picture.h"

#include <fmt/format.h>
#include <miebrdf/error.h>
#include <zlib.h>

#include <cmath>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "pipeline/io/atomic_file.h"
#include "pipeline/io/plugin.h"

namespace miebrdf::plot {

namespace {

std::string description_of(const std::string& svg) {
    const auto from = svg.find("<desc>");
    const auto to = svg.find("</desc>");
    if (from == std::string::npos || to == std::string::npos) return {};
    std::string text = svg.substr(from + 6, to - from - 6);
    const std::pair<const char*, const char*> entities[] = {
        {"&lt;", "<"}, {"&gt;", ">"}, {"&quot;", "\""}, {"&#39;", "'"}, {"&amp;", "&"}};
    for (const auto& [entity, character] : entities) {
        for (auto at = text.find(entity); at != std::string::npos; at = text.find(entity, at + 1)) {
            text.replace(at, std::string_view(entity).size(), character);
        }
    }
    return text;
}

std::string ending_of(const std::string& path) {
    const auto dot = path.rfind('.');
    return dot == std::string::npos ? "" : path.substr(dot);
}

/// The plug-in draws.
std::string rasterise(const std::string& svg, int width, int height) {
    static const auto draw = plugin_function<void(const std::string&, int, int, std::string&)>(
        "rsvg", "miebrdf_rasterise", "librsvg2-dev");
    std::string png;
    draw(svg, width, height, png);
    return png;
}

std::string png_of(const Picture& picture, double scale) {
    if (!(scale >= 0.1 && scale <= 20)) {
        throw UsageError(
            fmt::format("picture scale {}; allowed: 0.1 to 20 pixels for each unit", scale));
    }
    std::string png = rasterise(picture.svg, static_cast<int>(std::lround(picture.width * scale)),
                                static_cast<int>(std::lround(picture.height * scale)));
    add_png_text(png, "Description", description_of(picture.svg));
    return png;
}

}  // namespace

bool png_is_available() { return has_plugin("rsvg"); }

void check_picture_path(const std::string& path) {
    const std::string ending = ending_of(path);
    if (ending != ".svg" && ending != ".png") {
        throw UsageError(
            fmt::format("picture '{}': unknown ending '{}'; allowed: .svg, .png", path, ending));
    }
    if (ending == ".png" && !png_is_available()) {
        throw UsageError("this build cannot write PNG (librsvg was missing); write .svg instead");
    }
}

void save_picture(const Picture& picture, const std::string& path, double scale) {
    check_picture_path(path);
    const std::string bytes = ending_of(path) == ".svg" ? picture.svg : png_of(picture, scale);
    AtomicFile file(path);
    file.stream() << bytes;
    file.commit();
}

std::string big_endian(std::uint32_t value) {
    return {static_cast<char>(value >> 24), static_cast<char>(value >> 16),
            static_cast<char>(value >> 8), static_cast<char>(value)};
}

std::string png_chunk(const std::string& name, const std::string& data) {
    const std::string body = name + data;
    const auto size = static_cast<uInt>(body.size());
    return big_endian(static_cast<std::uint32_t>(data.size())) + body +
           big_endian(static_cast<std::uint32_t>(
               crc32(0, reinterpret_cast<const Bytef*>(body.data()), size)));
}

void add_png_text(std::string& png, const std::string& keyword, const std::string& text) {
    constexpr std::string_view kSignature = "\x89PNG\r\n\x1a\n";
    constexpr std::size_t kHeaderEnd =
        8 + 4 + 4 + 13 + 4;  // signature, then length, IHDR, data, CRC
    if (png.size() < kHeaderEnd || png.compare(0, kSignature.size(), kSignature) != 0) {
        throw std::invalid_argument("these bytes are not a PNG file");
    }
    if (text.empty()) return;
    // Keyword, its end, not compressed (two bytes), no language, no translated keyword, the text.
    png.insert(kHeaderEnd, png_chunk("iTXt", keyword + std::string(5, '\0') + text));
}

}  // namespace miebrdf::plot
