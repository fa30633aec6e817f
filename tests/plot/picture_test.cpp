#include "pipeline/plot/picture.h"

#include <cmath>
#include <cstdint>

#include <miebrdf/error.h>
#include "pipeline/plot/chart.h"
#include "tests/plot/svg_text.h"
#include "tests/support/catch.h"
#include "tests/support/temporary_folder.h"

using namespace miebrdf;
using namespace miebrdf::plot;

namespace {

Picture simple_picture() {
    return draw_chart({{{"x"}, {"y"}, {{"c", {0, 1}, {0, 1}}}}},
                      {"title", "miebrdf plot --base \"a & b\" <x>"});
}

std::uint32_t big_endian(const std::string& bytes, std::size_t at) {
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < 4; ++i)
        value = value << 8 | static_cast<unsigned char>(bytes.at(at + i));
    return value;
}

}  // namespace

TEST_CASE("an SVG file is the picture itself", "[plot][picture]") {
    const support::TemporaryFolder folder;
    const Picture picture = simple_picture();
    save_picture(picture, folder / "chart.svg");
    CHECK(support::read_file(folder / "chart.svg") == picture.svg);
    CHECK(support::is_well_formed(picture.svg));
}

TEST_CASE("a PNG file has the asked size, sound chunks and the command", "[plot][picture]") {
    if (!png_is_available()) {
        WARN("skipped: built without librsvg");
        return;
    }
    const support::TemporaryFolder folder;
    const Picture picture = simple_picture();
    save_picture(picture, folder / "chart.png", 1.5);
    const std::string png = support::read_file(folder / "chart.png");
    REQUIRE(png.compare(0, 8, "\x89PNG\r\n\x1a\n") == 0);
    CHECK(big_endian(png, 16) == static_cast<std::uint32_t>(std::lround(1.5 * picture.width)));
    CHECK(big_endian(png, 20) == static_cast<std::uint32_t>(std::lround(1.5 * picture.height)));
    bool described = false, ended = false;
    for (std::size_t at = 8; at < png.size();) {
        const std::size_t length = big_endian(png, at);
        const std::string type = png.substr(at + 4, 4);
        CHECK(png.substr(at, 12 + length) == png_chunk(type, png.substr(at + 8, length)));
        described = described || (type == "iTXt" && png.substr(at + 8, length) ==
                                                        "Description" + std::string(5, '\0') +
                                                            "miebrdf plot --base \"a & b\" <x>");
        ended = type == "IEND";
        at += 12 + length;
    }
    CHECK(described);
    CHECK(ended);
}

TEST_CASE("the checksum is that of the PNG specification", "[plot][picture]") {
    // The check value of CRC-32, and the last four bytes of every PNG file.
    CHECK(png_chunk("1234", "56789").substr(13) == "\xcb\xf4\x39\x26");
    CHECK(png_chunk("IEND", "").substr(8) == "\xae\x42\x60\x82");
}

TEST_CASE("pictures refuse endings and sizes that they cannot have", "[plot][picture][errors]") {
    const support::TemporaryFolder folder;
    const Picture picture = simple_picture();
    CHECK_THROWS_AS(save_picture(picture, folder / "chart.gif"), UsageError);
    CHECK_THROWS_WITH(save_picture(picture, folder / "chart"), Catch::Contains(".svg, .png"));
    CHECK_THROWS_AS(save_picture(picture, folder / "no/such/chart.svg"), InputError);
    if (png_is_available()) {
        CHECK_THROWS_WITH(save_picture(picture, folder / "chart.png", 0.0),
                          Catch::Contains("0.1 to 20"));
    }
    CHECK(folder.count() == 0);
    std::string text = "no picture";
    CHECK_THROWS_AS(add_png_text(text, "Description", "x"), std::invalid_argument);
}
