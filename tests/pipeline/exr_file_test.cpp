// Files of OpenEXR's interface for C++, which miebrdf does without, and back.
#include "pipeline/io/exr_file.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfOutputFile.h>
#include <ImfTileDescription.h>
#include <ImfTiledOutputFile.h>
#include <OpenEXRConfig.h>
#include <half.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "tests/support/catch.h"
#include "tests/support/temporary_folder.h"

using namespace miebrdf;

namespace {

// Not the origin, and no multiple of a tile or of the lines that are compressed together.
const Imath::Box2i kWindow({-3, 5}, {41, 77});
constexpr int kWidth = 45, kHeight = 73;

/// Smooth, so that compressions with loss stay near; every value is exact as a half float.
float value_at(int x, int y, int channel) { return 1.0F + float(x + y + 8 * channel) / 128.0F; }

std::string content_of(const std::string& path) {
    std::ostringstream content;
    content << std::ifstream(path, std::ios::binary).rdbuf();
    return content.str();
}

/// A picture by OpenEXR: R as half floats, G and B as floats or as half floats, too.
void write(const std::string& path, Imf::Compression compression, bool in_tiles, bool in_halves) {
    Imf::Header header(kWindow, kWindow);
    header.compression() = compression;
    std::vector<half> half_red, half_green, half_blue;
    std::vector<float> green, blue;
    for (int y = 0; y < kHeight; ++y) {
        for (int x = 0; x < kWidth; ++x) {
            half_red.emplace_back(value_at(x, y, 0));
            half_green.emplace_back(green.emplace_back(value_at(x, y, 1)));
            half_blue.emplace_back(blue.emplace_back(value_at(x, y, 2)));
        }
    }
    Imf::FrameBuffer buffer;
    const auto add = [&](const char* name, Imf::PixelType type, void* values, std::size_t size) {
        header.channels().insert(name, Imf::Channel(type));
        buffer.insert(name, Imf::Slice::Make(type, values, kWindow, size, size * kWidth));
    };
    add("R", Imf::HALF, half_red.data(), sizeof(half));
    if (in_halves) {
        add("G", Imf::HALF, half_green.data(), sizeof(half));
        add("B", Imf::HALF, half_blue.data(), sizeof(half));
    } else {
        add("G", Imf::FLOAT, green.data(), sizeof(float));
        add("B", Imf::FLOAT, blue.data(), sizeof(float));
    }
    if (in_tiles) {
        header.setTileDescription(Imf::TileDescription(16, 32, Imf::MIPMAP_LEVELS));
        Imf::TiledOutputFile file(path.c_str(), header);
        file.setFrameBuffer(buffer);
        file.writeTiles(0, file.numXTiles() - 1, 0, file.numYTiles() - 1);
    } else {
        Imf::OutputFile file(path.c_str(), header);
        file.setFrameBuffer(buffer);
        file.writePixels(kHeight);
    }
}

}  // namespace

TEST_CASE("exr_file reads every compression of OpenEXR's, lines and tiles, floats and halves",
          "[io][exr]") {
    const auto compression = GENERATE(range(0, int(Imf::NUM_COMPRESSION_METHODS)));
    const bool in_tiles = GENERATE(false, true), in_halves = GENERATE(false, true);
    CAPTURE(compression, in_tiles, in_halves);
    const support::TemporaryFolder folder;
    write(folder / "a.exr", Imf::Compression(compression), in_tiles, in_halves);

    const std::string content = content_of(folder / "a.exr");
    const ExrReader file(content);
    REQUIRE(file.width() == kWidth);
    REQUIRE(file.height() == kHeight);
    CHECK_FALSE(file.begins_at_origin());
    CHECK(file.channels() == std::vector<std::string>{"B", "G", "R"});
    std::vector<float> rgb(std::size_t(3 * kWidth * kHeight));
    std::vector<ExrPlane<float>> planes;
    for (const char* name : {"R", "G", "B"})
        planes.push_back({name, &rgb[planes.size()], 3, 3 * kWidth});
#if OPENEXR_VERSION_MAJOR == 3 && OPENEXR_VERSION_MINOR < 2
    if (compression == Imf::DWAA_COMPRESSION || compression == Imf::DWAB_COMPRESSION) {
        CHECK_THROWS_WITH(file.read(planes), Catch::Contains("DWA, which needs OpenEXR 3.2"));
        return;
    }
#endif
    file.read(planes);

    // PXR24 keeps 24 bits of floats; B44 loses one part in 40 of halves, DWA of all values.
    const bool loses = compression == Imf::B44_COMPRESSION ||
                       compression == Imf::B44A_COMPRESSION ||
                       compression == Imf::DWAA_COMPRESSION || compression == Imf::DWAB_COMPRESSION;
    const double bound = loses ? 0.025 : compression == Imf::PXR24_COMPRESSION ? 1e-4 : 0.0;
    double worst = 0.0;
    for (int y = 0; y < kHeight; ++y) {
        for (int x = 0; x < kWidth; ++x) {
            for (int c = 0; c < 3; ++c) {
                const double expected = value_at(x, y, c);
                const double read = rgb[std::size_t((y * kWidth + x) * 3 + c)];
                worst = std::max(worst, std::abs(read / expected - 1));
            }
        }
    }
    CHECK(worst <= bound);
}

TEST_CASE("OpenEXR reads what exr_file writes, lines by lines, bit by bit", "[io][exr]") {
    const int at_a_time = GENERATE(1, 7, 16, 40, kHeight);
    const support::TemporaryFolder folder;
    const std::vector<std::string> names = {"R", "T.550,000000nm", "G"};
    std::vector<float> values;
    for (int i = 0; i < 3 * kWidth * kHeight; ++i) values.push_back(std::sqrt(float(i)));
    {
        std::ostringstream out;  // cannot seek beyond its end
        ExrWriter file(out, {.width = kWidth,
                             .height = kHeight,
                             .channels = names,
                             .texts = {{"note", "text"}},
                             .lists = {{"list", {1.5F, 2.5F}}},
                             .numbers = {{"number", 0.1}}});
        for (int first = 0; first < kHeight; first += at_a_time) {
            std::vector<ExrPlane<const float>> planes;
            for (const std::string& name : names) {
                planes.push_back(
                    {name, &values[planes.size() * kWidth * kHeight + std::size_t(first) * kWidth],
                     1, kWidth});
            }
            file.write_lines(std::min(at_a_time, kHeight - first), planes);
        }
        file.finish();
        std::ofstream(folder / "a.exr", std::ios::binary) << out.str();
    }
    Imf::InputFile file((folder / "a.exr").c_str());
    const Imath::Box2i window({0, 0}, {kWidth - 1, kHeight - 1});
    REQUIRE(file.header().dataWindow() == window);
    std::vector<float> read(values.size());
    Imf::FrameBuffer buffer;
    for (std::size_t c = 0; c < names.size(); ++c) {
        buffer.insert(names[c], Imf::Slice::Make(Imf::FLOAT, &read[c * kWidth * kHeight], window,
                                                 sizeof(float), sizeof(float) * kWidth));
    }
    file.setFrameBuffer(buffer);
    file.readPixels(0, kHeight - 1);
    CHECK(read == values);

    const std::string content = content_of(folder / "a.exr");
    const ExrReader back(content);
    CHECK(back.list("list") == std::vector<float>{1.5F, 2.5F});
    CHECK(back.number("number") == 0.1);
    CHECK_FALSE(back.list("number"));
    CHECK_FALSE(back.number("none"));
}

TEST_CASE("exr_file refuses damaged files and unfinished pictures with a reason",
          "[io][exr][errors]") {
    CHECK_THROWS_AS(ExrReader("no picture"), std::runtime_error);
    const support::TemporaryFolder folder;
    // OpenEXR 3.1 crashes where only one channel of three half floats is asked for as documented.
    const bool in_halves = GENERATE(false, true);
    write(folder / "a.exr", Imf::ZIP_COMPRESSION, false, in_halves);
    const std::string content = content_of(folder / "a.exr");
    std::vector<float> values(std::size_t(kWidth * kHeight));
    const ExrPlane<float> plane{"G", values.data(), 1, kWidth};
    for (std::size_t size = 0; size < content.size(); size += 97) {
        const std::string part = content.substr(0, size);
        CAPTURE(size);
        CHECK_THROWS_AS(ExrReader(part).read({&plane, 1}), std::runtime_error);
    }
    std::ostringstream out;
    ExrWriter file(out, {.width = 2, .height = 2, .channels = {"Y"}});
    CHECK_THROWS_WITH(file.finish(), Catch::Contains("ends early"));
}
