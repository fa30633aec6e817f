#include <algorithm>
#include <cstring>

#include "pipeline/formats/rgl/tables.h"
#include "tests/support/catch.h"
#include "tests/support/test_material.h"
#include "tests/support/written_file.h"

using namespace miebrdf;
using namespace miebrdf::exports;
using support::material;
using support::written_file;

namespace {

std::string spectral_file(int resolution) {
    return written_file("rgl", material(), {.resolution = resolution});
}

}  // namespace

TEST_CASE("rgl: the container is laid out as RGL's readers expect", "[exports][rgl]") {
    const std::string content = spectral_file(8);
    CHECK(content.substr(0, 12) == std::string("tensor_file\0", 12));
    CHECK(content[12] == 1);
    CHECK(content[13] == 0);
    // First field: name length, name, dimensions, type u8, offset, shape.
    std::uint16_t name_length = 0, dimensions = 0;
    std::uint64_t offset = 0, extent = 0;
    std::memcpy(&name_length, content.data() + 18, 2);
    REQUIRE(name_length == 11);
    CHECK(content.substr(20, 11) == "description");
    std::memcpy(&dimensions, content.data() + 31, 2);
    CHECK(dimensions == 1);
    CHECK(content[33] == 1);
    std::memcpy(&offset, content.data() + 34, 8);
    std::memcpy(&extent, content.data() + 42, 8);
    CHECK(offset % 8 == 0);
    CHECK(content[offset] == '{');
    CHECK(content[offset + extent - 1] == '}');
    for (const char* name : {"phi_i", "theta_i", "ndf", "sigma", "vndf", "luminance", "jacobian",
                             "wavelengths", "spectra"}) {
        CHECK_THAT(content, Catch::Contains(name));
    }
}

TEST_CASE("rgl: nothing stored is negative, even beside a lobe that the grid does not resolve",
          "[exports][rgl]") {
    // pbrt-v4 counts negative values as an error and Mitsuba 3 renders with them.
    const double alpha = GENERATE(0.3, 0.05, 0.01);
    const support::SharpMaterial sharp(support::seven_wavelengths(), alpha);
    const std::string content =
        written_file("rgl", sharp, {.resolution = 24, .extra = {{"incident_angles", 8}}});
    const auto fields = read_tensor_file(content);
    const auto least = [&](const char* name) {
        const auto values = tensor_floats(fields, name);
        float lowest = values[0];
        for (std::size_t i = 1; i < values.size(); ++i) lowest = std::min(lowest, values[i]);
        return lowest;
    };
    CAPTURE(alpha);
    CHECK(least("spectra") >= 0.0f);
    CHECK(least("luminance") > 0.0f);
}

TEST_CASE("rgl: the RGB file names its channels", "[exports][rgl]") {
    const auto read = read_brdf_file(written_file("rgl", material(), {.resolution = 8}, 1), "test");
    CHECK(read->channels() == std::vector<std::string>{"R", "G", "B"});
}

TEST_CASE("rgl: options out of range are refused", "[exports][rgl][errors]") {
    CHECK_THROWS_WITH(spectral_file(2), Catch::Contains("4 to 1024"));
    CHECK_THROWS_WITH(written_file("rgl", material(), {.extra = {{"incident_angles", 1}}}),
                      Catch::Contains("incident_angles") && Catch::Contains("2 to 512"));
    CHECK_THROWS_AS(written_file("rgl", support::ColouredMaterial().rgb), UsageError);
    const support::TestMaterial falling({650, 450}, 0.4);
    CHECK_THROWS_WITH(export_brdf(falling, "rgl", "x"), Catch::Contains("450 nm follows 650 nm"));
}
