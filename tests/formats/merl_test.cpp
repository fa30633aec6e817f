#include "tests/support/catch.h"
#include "tests/support/outside/bytes.h"
#include "tests/support/test_material.h"
#include "tests/support/written_file.h"

using namespace miebrdf;

TEST_CASE("merl: size, scale and bins are those of the format", "[formats][merl]") {
    const support::ColouredMaterial material;
    const std::string file = support::written_file("merl", material.spectral);
    CHECK(file.size() == 34'992'012);
    CHECK(support::numbers_at<std::int32_t>(file, 0, 3) == std::vector<std::int32_t>{90, 90, 180});
    const auto bin = [&](std::size_t channel, std::size_t half, std::size_t difference) {
        const std::size_t index = 180 * (difference + 90 * (half + 90 * channel));
        return support::number_at<double>(file, 12 + 8 * index);
    };
    // Half vector along the normal, difference 60 degrees: both at 60 degrees, mirror directions.
    double rgb[3];
    const Direction mirror{0.5, 0.5, 0.0};
    material.rgb.evaluate({&mirror, 1}, rgb);
    const double scale[3] = {1500, 1500 / 1.15, 1500 / 1.66};
    for (std::size_t c = 0; c < 3; ++c)
        CHECK(bin(c, 0, 60) == Approx(rgb[c] * scale[c]).epsilon(1e-12));
    // Half vector 45 degrees off, difference 80 degrees in its plane: one below the horizon.
    CHECK(bin(0, 64, 80) == -1.0);
}
