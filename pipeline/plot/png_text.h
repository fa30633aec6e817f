// A text inside a PNG file.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace miebrdf::plot {

/// Adds an iTXt chunk (UTF-8, not compressed; PNG specification, 11.3.4.5) behind the header chunk
/// of a PNG file. An empty text adds nothing.
/// @throws std::invalid_argument  when the bytes do not begin like a PNG file
void add_png_text(std::string& png, const std::string& keyword, const std::string& text);

/// CRC-32 of the PNG specification, annex D.
std::uint32_t crc32(std::string_view bytes);

}  // namespace miebrdf::plot
