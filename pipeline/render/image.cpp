#include "pipeline/render/image.h"

#include <fmt/format.h>
#include <miebrdf/colour.h>
#include <miebrdf/error.h>
#include <png.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <memory>
#include <sstream>

#include "pipeline/io/atomic_file.h"
#include "pipeline/io/exr_file.h"

namespace miebrdf::render {

namespace {

template <typename Float>
ExrPlane<Float> plane_of(const std::string& name, const Image& image, Float* values, int channel) {
    return {name, values + channel, std::size_t(image.channels),
            std::size_t(image.channels) * std::size_t(image.width)};
}

Image read_open_exr(const std::string& content, const std::string& path) {
    const ExrReader file(content);
    Image image(file.width(), file.height(), 3);
    const std::vector<std::string>& channels = file.channels();
    const auto has = [&](const char* name) {
        return std::find(channels.begin(), channels.end(), name) != channels.end();
    };
    const bool is_grey = !has("R") && has("Y");
    const char* const names[] = {"R", "G", "B"};
    std::vector<ExrPlane<float>> planes;
    for (int c = 0; c < (is_grey ? 1 : 3); ++c) {
        const char* name = is_grey ? "Y" : names[c];
        if (!has(name)) {
            throw InputError(
                fmt::format("{}: has no channel {}; wanted: R, G, B or Y", path, name));
        }
        planes.push_back(plane_of(name, image, image.values.data(), c));
    }
    file.read(planes);
    if (is_grey) {
        for (std::size_t i = 0; i < image.values.size(); i += 3) {
            image.values[i + 1] = image.values[i + 2] = image.values[i];
        }
    }
    return image;
}

/// Opening a pipe waits until somebody writes into it.
std::ifstream open_picture(const std::string& path) {
    if (!std::filesystem::exists(path)) throw InputError(fmt::format("{}: no such file", path));
    if (!std::filesystem::is_regular_file(path))
        throw InputError(fmt::format("{}: no ordinary file", path));
    return std::ifstream(path, std::ios::binary);
}

}  // namespace

Image read_exr(const std::string& path) {
    std::ostringstream content;
    content << open_picture(path).rdbuf();
    try {
        return read_open_exr(content.str(), path);
    } catch (const InputError&) {
        throw;
    } catch (const std::exception& error) {
        throw InputError(fmt::format("{}: cannot be read as OpenEXR: {}", path, error.what()));
    }
}

void write_exr(const Image& image, const std::vector<std::string>& channel_names,
               const PictureNotes& notes, const std::string& path) {
    if (channel_names.size() != std::size_t(image.channels)) {
        throw std::invalid_argument(
            fmt::format("{} channel names for {} channels", channel_names.size(), image.channels));
    }
    std::vector<ExrPlane<const float>> planes;
    planes.reserve(channel_names.size());
    for (int c = 0; c < image.channels; ++c)
        planes.push_back(plane_of(channel_names[std::size_t(c)], image, image.values.data(), c));
    AtomicFile target(path);
    try {
        ExrWriter file(target.stream(), {.width = image.width,
                                         .height = image.height,
                                         .channels = channel_names,
                                         .texts = notes});
        file.write_lines(image.height, planes);
        file.finish();
    } catch (const std::exception& error) {
        throw InputError(fmt::format("{}: cannot be written: {}", path, error.what()));
    }
    target.commit();
}

// Radiance's picture format (G. Ward, "Real Pixels", Graphics Gems II; the `picture(5)` manual
// page): text header, resolution line, then pixels of three mantissas and a common exponent.

namespace {

using Rgbe = std::array<std::uint8_t, 4>;

class HdrReader {
  public:
    explicit HdrReader(const std::string& path) : path_(path), in_(open_picture(path)) {}

    Image read() {
        read_header();
        Image image = sized_image();
        std::vector<Rgbe> line(std::size_t(image.width));
        for (int y = 0; y < image.height; ++y) {
            read_line(line);
            for (int x = 0; x < image.width; ++x) decode(line[std::size_t(x)], image.pixel(x, y));
        }
        return image;
    }

  private:
    [[noreturn]] void fail(const std::string& what) const {
        throw InputError(fmt::format("{}: cannot be read as a Radiance picture: {}", path_, what));
    }

    std::uint8_t byte() {
        const int c = in_.get();
        if (c == std::char_traits<char>::eof()) fail("the file ends early");
        return std::uint8_t(c);
    }

    void read_header() {
        std::string line;
        std::getline(in_, line);
        if (line.rfind("#?", 0) != 0) fail("it does not begin with #?RADIANCE");
        while (std::getline(in_, line) && !line.empty()) {
            if (line.rfind("FORMAT=", 0) == 0 && line != "FORMAT=32-bit_rle_rgbe") {
                fail(line + "; wanted: 32-bit_rle_rgbe");
            }
        }
    }

    /// The usual orientation alone: rows from the top, pixels from the left.
    Image sized_image() {
        std::string line, y_axis, x_axis;
        std::getline(in_, line);
        int height = 0, width = 0;
        if (!(std::istringstream(line) >> y_axis >> height >> x_axis >> width) || y_axis != "-Y" ||
            x_axis != "+X" || !(width > 0 && width <= 65536 && height > 0 && height <= 65536)) {
            fail(fmt::format("resolution '{}'; wanted: -Y HEIGHT +X WIDTH", line));
        }
        return Image(width, height, 3);
    }

    void read_line(std::vector<Rgbe>& line) {
        Rgbe first;
        for (auto& value : first) value = byte();
        const std::size_t width = line.size();
        const bool coded = first[0] == 2 && first[1] == 2 && first[2] < 128;
        if (!coded) {
            line[0] = first;
            for (std::size_t x = 1; x < width; ++x) {
                for (auto& value : line[x]) value = byte();
            }
            return;
        }
        if (std::size_t(first[2]) * 256 + first[3] != width) fail("a line of another width");
        for (std::size_t c = 0; c < 4; ++c) read_runs(line, c);
    }

    /// One component of a line: runs (count above 128, one value) and dumps (count, values).
    void read_runs(std::vector<Rgbe>& line, std::size_t component) {
        for (std::size_t x = 0; x < line.size();) {
            const std::uint8_t code = byte();
            const bool is_run = code > 128;
            const std::size_t count = is_run ? code - 128U : code;
            if (count == 0 || x + count > line.size()) fail("a damaged line");
            std::uint8_t value = is_run ? byte() : 0;
            for (std::size_t k = 0; k < count; ++k, ++x) {
                if (!is_run) value = byte();
                line[x][component] = value;
            }
        }
    }

    static void decode(const Rgbe& rgbe, float* rgb) {
        const double scale = rgbe[3] == 0 ? 0.0 : std::ldexp(1.0, int(rgbe[3]) - (128 + 8));
        for (std::size_t c = 0; c < 3; ++c)
            rgb[c] = rgbe[3] == 0 ? 0.0F : float((rgbe[c] + 0.5) * scale);
    }

    std::string path_;
    std::ifstream in_;
};

}  // namespace

Image read_hdr(const std::string& path) { return HdrReader(path).read(); }

namespace {

/// Frees what libpng allocated for reading, however reading ends.
struct ImageGuard {
    png_image image{};
    ImageGuard() { image.version = PNG_IMAGE_VERSION; }
    ~ImageGuard() { png_image_free(&image); }
};

/// Owns the two structures of libpng's writer.
struct Writer {
    png_structp png = nullptr;
    png_infop info = nullptr;
    explicit Writer(std::ostream& out) {
        png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, &ignore);
        info = png_create_info_struct(png);
        png_set_write_fn(png, &out, &write, &flush);
    }
    ~Writer() { png_destroy_write_struct(&png, &info); }

    static void ignore(png_structp, png_const_charp) {}
    static void write(png_structp png, png_bytep data, png_size_t size) {
        auto* out = static_cast<std::ostream*>(png_get_io_ptr(png));
        out->write(reinterpret_cast<const char*>(data), std::streamsize(size));
    }
    static void flush(png_structp) {}
};

std::vector<std::uint8_t> encode(const Image& linear) {
    std::vector<std::uint8_t> bytes(linear.values.size());
    for (std::size_t i = 0; i < bytes.size(); ++i) {
        const bool is_alpha = linear.channels == 4 && i % 4 == 3;
        const double value = std::clamp(double(linear.values[i]), 0.0, 1.0);
        bytes[i] = std::uint8_t(std::lround(255.0 * (is_alpha ? value : encode_srgb(value))));
    }
    return bytes;
}

void set_notes(const Writer& writer, const PictureNotes& notes) {
    for (const auto& [key, text] : notes) {
        png_text chunk{};
        chunk.compression = PNG_TEXT_COMPRESSION_NONE;
        chunk.key = const_cast<char*>(key.c_str());
        chunk.text = const_cast<char*>(text.c_str());
        chunk.text_length = text.size();
        png_set_text(writer.png, writer.info, &chunk, 1);
    }
}

/// libpng reports errors by longjmp, so nothing here has a destructor.
bool write_all(const Writer& writer, const Image& size, const PictureNotes& notes,
               const std::uint8_t* bytes) {
    if (setjmp(png_jmpbuf(writer.png)) != 0) return false;
    png_set_IHDR(writer.png, writer.info, png_uint_32(size.width), png_uint_32(size.height), 8,
                 size.channels == 4 ? PNG_COLOR_TYPE_RGBA : PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE,
                 PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    png_set_sRGB(writer.png, writer.info, PNG_sRGB_INTENT_RELATIVE);
    set_notes(writer, notes);
    png_set_compression_level(writer.png, 9);
    png_write_info(writer.png, writer.info);
    for (int y = 0; y < size.height; ++y) {
        png_write_row(writer.png, bytes + std::ptrdiff_t(y) * size.width * size.channels);
    }
    png_write_end(writer.png, writer.info);
    return true;
}

}  // namespace

Image read_grey_png(const std::string& path) {
    if (!std::filesystem::exists(path)) throw InputError(fmt::format("{}: no such file", path));
    ImageGuard guard;
    if (png_image_begin_read_from_file(&guard.image, path.c_str()) == 0) {
        throw InputError(fmt::format("{}: cannot be read as a PNG: {}", path, guard.image.message));
    }
    // Three channels, not one: libpng would weigh colours after removing the transfer function.
    guard.image.format = PNG_FORMAT_RGB;
    std::vector<png_byte> bytes(PNG_IMAGE_SIZE(guard.image));
    const png_color black{0, 0, 0};
    if (png_image_finish_read(&guard.image, &black, bytes.data(), 0, nullptr) == 0) {
        throw InputError(fmt::format("{}: damaged PNG: {}", path, guard.image.message));
    }
    Image grey(int(guard.image.width), int(guard.image.height), 1);
    for (std::size_t i = 0; i < grey.values.size(); ++i) {
        const int sum = bytes[3 * i] + bytes[3 * i + 1] + bytes[3 * i + 2];
        grey.values[i] = float(sum) / (3.0F * 255.0F);
    }
    return grey;
}

void write_png(const Image& linear, const PictureNotes& notes, const std::string& path) {
    if (linear.channels != 3 && linear.channels != 4) {
        throw std::invalid_argument(
            fmt::format("PNG with {} channels; allowed: 3, 4", linear.channels));
    }
    const std::vector<std::uint8_t> bytes = encode(linear);
    AtomicFile file(path);
    if (!write_all(Writer(file.stream()), linear, notes, bytes.data())) {
        throw InputError(fmt::format("{}: libpng refuses the picture", path));
    }
    file.commit();
}

}  // namespace miebrdf::render
