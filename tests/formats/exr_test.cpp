#include <cmath>

#include "tests/support/catch.h"
#include "tests/support/test_material.h"
#include "tests/support/written_file.h"

using namespace miebrdf;
using namespace miebrdf::exports;

TEST_CASE("exr: channels carry the names of the spectral layout and the values as floats",
          "[exports][exr]") {
    const support::TestMaterial material(support::seven_wavelengths(), 0.4);
    const rte::Directions grid{{0.25, 0.5, 1.0}, {0.125, 0.5, 1.0}, {0, 45, 90, 180}};
    const std::string content = support::written_file("exr", material, {.directions = grid});
    for (const char* text :
         {"T.550,000000nm", "T.400,000000nm", "spectralLayoutVersion", "mu_in", "azimuth_deg"}) {
        CHECK_THAT(content, Catch::Contains(text));
    }
    const auto read = read_brdf_file(content, "test");
    CHECK(read->format() == "exr");
    CHECK(read->wavelength_nm() == material.wavelength_nm());
    std::vector<double> expected(7), found(7);
    for (const double mu_in : grid.mu_in) {
        for (const double mu_out : grid.mu_out) {
            for (const double azimuth : grid.azimuth_deg) {
                const Direction direction{mu_in, mu_out, azimuth};
                material.evaluate({&direction, 1}, expected);
                read->evaluate(direction, found);
                // Single precision: half a unit in the last place.
                for (std::size_t c = 0; c < 7; ++c)
                    CHECK(std::abs(found[c] / expected[c] - 1) <= 6e-8);
            }
        }
    }
}

TEST_CASE("exr: an attribute that claims more than the file has is refused before it is allocated",
          "[exports][exr]") {
    using namespace std::string_literals;
    const std::string start = "\x76\x2f\x31\x01\x02\0\0\0"s;
    const std::string huge = start + "mu_in\0floatvector\0\xf0\xff\xff\x7f"s + "few bytes";
    CHECK_THROWS_WITH(read_brdf_file(huge, "test"),
                      Catch::Contains("'mu_in' claims 2147483632 bytes of the 9"));
    const std::string window =
        start + "dataWindow\0box2i\0\x10\0\0\0\0\0\0\0\0\0\0\0\xff\xff\0\0\xff\xff\x0f\0\0"s;
    CHECK_THROWS_WITH(read_brdf_file(window, "test"),
                      Catch::Contains("a window of 65536 x 1048576 pixels"));
    CHECK_THROWS_WITH(read_brdf_file(start + "mu_in", "test"),
                      Catch::Contains("header ends early"));
    CHECK_THROWS_WITH(read_brdf_file("\x76\x2f\x31\x01\x02\x10\0\0"s, "test"),
                      Catch::Contains("one flat part"));
}
