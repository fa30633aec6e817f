#include "pipeline/plot/png_text.h"

#include <stdexcept>

namespace miebrdf::plot {
namespace {

std::string big_endian(std::uint32_t value) {
    return {static_cast<char>(value >> 24), static_cast<char>(value >> 16),
            static_cast<char>(value >> 8), static_cast<char>(value)};
}

}  // namespace

std::uint32_t crc32(std::string_view bytes) {
    std::uint32_t crc = 0xffffffffu;
    for (const char byte : bytes) {
        crc ^= static_cast<unsigned char>(byte);
        for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1) ^ ((crc & 1) != 0 ? 0xedb88320u : 0u);
    }
    return ~crc;
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
    const std::string chunk = "iTXt" + keyword + std::string(5, '\0') + text;
    const std::string length = big_endian(static_cast<std::uint32_t>(chunk.size() - 4));
    png.insert(kHeaderEnd, length + chunk + big_endian(crc32(chunk)));
}

}  // namespace miebrdf::plot
