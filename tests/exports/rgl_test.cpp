#include "pipeline/exports/rgl_writer.h"

#include <cmath>
#include <cstring>
#include <sstream>

#include "pipeline/error.h"
#include "pipeline/exports/deviation.h"
#include "tests/support/catch.h"
#include "tests/support/sampling.h"
#include "tests/support/test_material.h"

using namespace miebrdf;
using namespace miebrdf::exports;

namespace {

const support::TestMaterial& material() {
    static const support::TestMaterial instance(support::seven_wavelengths(), 0.4);
    return instance;
}

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

TEST_CASE("rgl: read as Mitsuba and pbrt-v4 read it, errors stay within docs/formats/rgl.md",
          "[exports][rgl]") {
    // Twice what a correct writer of this kind reached.
    const auto [resolution, bounds] = GENERATE(std::pair{16, std::array{7.4e-2, 0.30, 2.4}},
                                               std::pair{32, std::array{1.7e-2, 9.8e-2, 1.12}},
                                               std::pair{64, std::array{4.4e-3, 3.2e-2, 0.52}});
    const auto read = read_brdf_file(spectral_file(resolution), "test");
    const Deviation deviation = measure_deviation(*read, material(), random_directions(6000, 1));
    CAPTURE(resolution, deviation.rms);
    for (std::size_t band = 0; band < 3; ++band) CHECK(deviation.rms[band] <= bounds[band]);
}

TEST_CASE("rgl: the RGB file holds the same BRDF in three channels", "[exports][rgl]") {
    const RgbSource rgb(material(), nearest_wavelengths(support::seven_wavelengths()));
    std::ostringstream out;
    write_rgl_rgb(rgb, {.resolution = 32}, out);
    const auto read = read_brdf_file(out.str(), "test");
    CHECK(read->channels() == std::vector<std::string>{"R", "G", "B"});
    const Deviation deviation = measure_deviation(*read, rgb, random_directions(3000, 2));
    CHECK(deviation.rms[0] <= 1.7e-2);
}

TEST_CASE("rgl: importance sampling carries the albedo and draws by its density",
          "[exports][rgl]") {
    const auto read = read_brdf_file(spectral_file(32), "test");
    for (const double mu : {0.3, 0.9}) {
        const auto sampled = support::sampled_albedo(*read, mu, 4000);
        const auto expected = support::integrated_albedo(material(), mu);
        CAPTURE(mu, sampled, expected);
        for (std::size_t c = 0; c < expected.size(); ++c)
            CHECK(std::abs(sampled[c] / expected[c] - 1) <= 1e-2);
        const double probability = support::chi_square_probability(*read, mu, 20000);
        CAPTURE(probability);
        CHECK(probability >= 1e-3);
    }
}

TEST_CASE("rgl: options out of range are refused", "[exports][rgl][errors]") {
    std::ostringstream out;
    CHECK_THROWS_WITH(write_rgl_spectral(material(), {.resolution = 2}, out),
                      Catch::Contains("4 to 1024"));
    CHECK_THROWS_WITH(write_rgl_spectral(material(), {.incident_angles = 1}, out),
                      Catch::Contains("2 to 512"));
    const RgbSource rgb(material(), nearest_wavelengths(support::seven_wavelengths()));
    CHECK_THROWS_AS(write_rgl_spectral(rgb, {}, out), UsageError);
}
