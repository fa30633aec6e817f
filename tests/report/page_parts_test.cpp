// A page has, beside its tables, numbers as text and weights of colours.
#include <string>
#include <vector>

#include "pipeline/io/markup.h"
#include "pipeline/report/packed.h"
#include "pipeline/report/report_data.h"
#include "tests/support/catch.h"

using namespace miebrdf;

TEST_CASE("base64 is that of RFC 4648, section 10", "[report]") {
    CHECK(base64("") == "");
    CHECK(base64("f") == "Zg==");
    CHECK(base64("fo") == "Zm8=");
    CHECK(base64("foo") == "Zm9v");
    CHECK(base64("foobar") == "Zm9vYmFy");
}

TEST_CASE("a page says how its colours are weighted, where its wavelengths allow colours",
          "[report]") {
    CHECK(report::colour_weights({450, 550, 650}).is_null());
    std::vector<double> wavelength_nm;
    for (int nm = 400; nm <= 700; nm += 10) wavelength_nm.push_back(nm);
    const auto lights = report::colour_weights(wavelength_nm);
    REQUIRE(lights.size() == 4);
    for (const auto& light : lights) {
        // A reflectance of 1 is white under each of them, and (1, 1, 1) in adapted sRGB.
        double y = 0.0, red = 0.0;
        for (std::size_t w = 0; w < wavelength_nm.size(); ++w) {
            y += light["y"][w].get<double>();
            red += light["srgb"][0].get<double>() * light["x"][w].get<double>() +
                   light["srgb"][1].get<double>() * light["y"][w].get<double>() +
                   light["srgb"][2].get<double>() * light["z"][w].get<double>();
        }
        CHECK(y == Approx(1.0).epsilon(1e-12));
        CHECK(red == Approx(1.0).epsilon(1e-6));
    }
}
