// Radiance's picture format (G. Ward, "Real Pixels", Graphics Gems II; the `picture(5)` manual
// page): text header, resolution line, then pixels of three mantissas and a common exponent.
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <sstream>

#include <miebrdf/error.h>
#include "pipeline/render/image.h"

namespace miebrdf::render {
namespace {

using Rgbe = std::array<std::uint8_t, 4>;

class HdrReader {
  public:
    explicit HdrReader(const std::string& path) : path_(path), in_(path, std::ios::binary) {
        if (!std::filesystem::exists(path)) throw InputError(fmt::format("{}: no such file", path));
    }

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

}  // namespace miebrdf::render
