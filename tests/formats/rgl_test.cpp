#include "pipeline/formats/rgl_writer.h"

#include <algorithm>
#include <cstring>
#include <sstream>

#include <miebrdf/error.h>
#include "pipeline/formats/readers/brdf_file.h"
#include "pipeline/formats/readers/tensor_file_reader.h"
#include "tests/support/catch.h"
#include "tests/support/test_material.h"

using namespace miebrdf;
using namespace miebrdf::exports;
using support::material;

namespace {

std::string spectral_file(int resolution) {
    std::ostringstream out;
    write_rgl_spectral(material(), {.resolution = resolution}, out);
    return out.str();
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
    std::ostringstream out;
    write_rgl_spectral(sharp, {.resolution = 24, .incident_angles = 8}, out);
    const std::string content = out.str();
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
    std::ostringstream out;
    write_rgl_rgb(support::ColouredMaterial().rgb, {.resolution = 8}, out);
    const auto read = read_brdf_file(out.str(), "test");
    CHECK(read->channels() == std::vector<std::string>{"R", "G", "B"});
}

TEST_CASE("rgl: options out of range are refused", "[exports][rgl][errors]") {
    std::ostringstream out;
    CHECK_THROWS_WITH(write_rgl_spectral(material(), {.resolution = 2}, out),
                      Catch::Contains("4 to 1024"));
    CHECK_THROWS_WITH(write_rgl_spectral(material(), {.incident_angles = 1}, out),
                      Catch::Contains("2 to 512"));
    CHECK_THROWS_AS(write_rgl_spectral(support::ColouredMaterial().rgb, {}, out), UsageError);
}
