// Pictures of 32-bit floats as OpenEXR files, read from memory and written to streams.
#pragma once

#include <cstddef>
#include <iosfwd>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace miebrdf {

/// The values of one channel in memory: pixel x of line y is values[y * line_stride + x *
/// pixel_stride], counted from the upper left corner of what is read or written.
template <typename Float>
struct ExrPlane {
    std::string channel;
    Float* values = nullptr;
    std::size_t pixel_stride = 1;
    std::size_t line_stride = 0;
};

/// A file of one part, in lines or tiles, with any of OpenEXR's compressions (DWA from OpenEXR 3.2
/// on). Not thread-safe. All functions throw std::runtime_error with OpenEXR's reason.
class ExrReader {
  public:
    /// @param content  of the file; has to live as long as this
    explicit ExrReader(std::string_view content);
    ~ExrReader();

    int width() const;
    int height() const;
    /// Whether the picture begins at pixel (0, 0).
    bool begins_at_origin() const;
    const std::vector<std::string>& channels() const;

    /// Attributes; nothing where there is none of this name and type.
    std::optional<std::vector<float>> list(const char* attribute) const;
    std::optional<double> number(const char* attribute) const;

    /// Fills the planes with the channels of their names; other planes are left as they are.
    void read(std::span<const ExrPlane<float>> planes) const;

  private:
    struct File;
    std::unique_ptr<File> file_;
};

/// The header of a file, before its pixels.
struct ExrHeader {
    int width = 0;
    int height = 0;
    std::vector<std::string> channels = {};
    std::vector<std::pair<std::string, std::string>> texts = {};
    std::vector<std::pair<std::string, std::vector<float>>> lists = {};
    std::vector<std::pair<std::string, double>> numbers = {};
};

/// Writes a picture from the top down, compressed without loss (ZIP). Not thread-safe.
/// All functions throw std::runtime_error with OpenEXR's reason.
class ExrWriter {
  public:
    /// @param out  has to be able to seek
    ExrWriter(std::ostream& out, const ExrHeader& header);
    ~ExrWriter();

    /// The next lines: of the planes those from 0 on. One plane for each channel.
    void write_lines(int count, std::span<const ExrPlane<const float>> planes);

    /// After the last line.
    void finish();

  private:
    struct File;
    std::unique_ptr<File> file_;
};

}  // namespace miebrdf
