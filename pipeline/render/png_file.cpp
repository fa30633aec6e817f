#include <fmt/format.h>
#include <png.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <memory>

#include <miebrdf/error.h>
#include "pipeline/io/atomic_file.h"
#include "pipeline/render/image.h"

namespace miebrdf::render {
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

double encode_srgb(double linear) {
    return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1.0 / 2.4) - 0.055;
}

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
