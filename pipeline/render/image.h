// Pictures in memory, and the files they come from and go to.
#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

namespace miebrdf::render {

/// Rows from the top, pixels from the left, channels interleaved.
struct Image {
    int width = 0;
    int height = 0;
    int channels = 0;
    std::vector<float> values;

    Image() = default;
    Image(int w, int h, int c)
        : width(w),
          height(h),
          channels(c),
          values(std::size_t(w) * std::size_t(h) * std::size_t(c)) {}
    float* pixel(int x, int y) {
        return &values[(std::size_t(y) * std::size_t(width) + std::size_t(x)) *
                       std::size_t(channels)];
    }
    const float* pixel(int x, int y) const { return const_cast<Image*>(this)->pixel(x, y); }
};

/// Key and text, written into a file beside the picture (PNG text chunks, EXR attributes).
using PictureNotes = std::vector<std::pair<std::string, std::string>>;

/// Reads any PNG as grey levels in [0, 1] as stored (no transfer function), one channel.
/// @throws InputError  when the file is missing or no PNG
Image read_grey_png(const std::string& path);

/// Writes 8-bit sRGB, three or four channels; values are linear in [0, 1] and are clipped to it.
/// Appears whole or not at all.
/// @throws InputError  when it cannot be written
void write_png(const Image& linear, const PictureNotes& notes, const std::string& path);

/// Reads the channels R, G, B (or Y) of an OpenEXR file as linear values.
/// @throws InputError  when the file is missing, no EXR, or has none of these channels
Image read_exr(const std::string& path);

/// Writes 32-bit float channels with the given names, one for each channel of the image.
void write_exr(const Image& image, const std::vector<std::string>& channel_names,
               const PictureNotes& notes, const std::string& path);

/// Reads a Radiance picture (.hdr, RGBE, flat or run-length coded) as linear RGB.
/// @throws InputError  when the file is missing, damaged or in XYZE
Image read_hdr(const std::string& path);

}  // namespace miebrdf::render
