// A finished chart and how it reaches a file.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace miebrdf::plot {

struct Picture {
    std::string svg;
    double width = 0.0, height = 0.0;  ///< in SVG units (96 for an inch)
};

/// Written into the picture besides its data.
struct Caption {
    std::string title;    ///< above the chart; may be empty
    std::string command;  ///< that made it: into the file, not onto the page
};

/// Refuses a path that save_picture would refuse, before any work is done.
/// @throws UsageError  for an ending other than .svg and .png, or .png in a build without it
void check_picture_path(const std::string& path);

/// Writes `.svg` or `.png` by the path's ending, whole or not at all. A PNG has `scale` pixels for
/// each SVG unit and carries the command as its "Description".
/// @throws UsageError  for another ending, a scale outside [0.1, 20], or PNG in a build without it
/// @throws InputError  when the file cannot be written
void save_picture(const Picture& picture, const std::string& path, double scale = 2.0);

/// Whether this build can write PNG.
bool png_is_available();

// A text inside a PNG file.

/// Adds an iTXt chunk (UTF-8, not compressed; PNG specification, 11.3.4.5) behind the header chunk
/// of a PNG file. An empty text adds nothing.
/// @throws std::invalid_argument  when the bytes do not begin like a PNG file
void add_png_text(std::string& png, const std::string& keyword, const std::string& text);

/// A number as PNG has it.
std::string big_endian(std::uint32_t value);
/// A chunk of PNG: length, name, data and their checksum.
std::string png_chunk(const std::string& name, const std::string& data);

}  // namespace miebrdf::plot
