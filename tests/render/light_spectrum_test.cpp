#include "pipeline/render/lighting.h"

#include <cmath>

#include <miebrdf/colour.h>
#include <miebrdf/error.h>
#include "tests/render/support.h"
#include "tests/support/catch.h"

using namespace miebrdf;
using namespace miebrdf::render;

namespace {

std::vector<double> every(double step_nm) {
    std::vector<double> wavelengths;
    for (double w = 380.0; w <= 780.0; w += step_nm) wavelengths.push_back(w);
    return wavelengths;
}

Image one_pixel(const std::vector<double>& spectrum) {
    Image image(1, 1, int(spectrum.size()));
    for (std::size_t w = 0; w < spectrum.size(); ++w) image.values[w] = float(spectrum[w]);
    return image;
}

}  // namespace

TEST_CASE("a white sphere in white light is white", "[render][colour]") {
    const auto wavelengths = every(10.0);
    RenderScene scene = sphere_scene(lambertian(std::vector<double>(wavelengths.size(), 1.0)));
    scene.lighting.environment = Environment::uniform(light_spectrum("white", wavelengths));
    const auto picture = render_picture(scene, parallel_camera(scene),
                                        {.width = 5, .height = 5, .samples = 4, .bounces = 1});
    const Image rgb = to_linear_srgb(picture.radiance, wavelengths);
    // The white point of sRGB is given to four digits.
    for (int c = 0; c < 3; ++c) CHECK(double(rgb.pixel(2, 2)[c]) == Approx(1.0).margin(1e-4));
}

TEST_CASE("tungsten light has the chromaticity of illuminant A", "[render][colour]") {
    // CIE 15:2004, table T.3: x = 0.44758, y = 0.40745; sRGB primaries of IEC 61966-2-1 turn that
    // into ratios of linear red, green and blue.
    const auto wavelengths = every(5.0);
    const Image rgb =
        to_linear_srgb(one_pixel(light_spectrum("blackbody:2855.5", wavelengths)), wavelengths);
    const double r = double(rgb.values[0]), g = double(rgb.values[1]), b = double(rgb.values[2]);
    const double X = 0.4124 * r + 0.3576 * g + 0.1805 * b;
    const double Y = 0.2126 * r + 0.7152 * g + 0.0722 * b;
    const double Z = 0.0193 * r + 0.1192 * g + 0.9505 * b;
    CHECK(X / (X + Y + Z) == Approx(0.44758).margin(1e-3));
    CHECK(Y / (X + Y + Z) == Approx(0.40745).margin(1e-3));
}

TEST_CASE("the spectrum of a colour has that colour", "[render][colour]") {
    const auto wavelengths = every(10.0);
    const auto basis = colour_basis(wavelengths);
    const std::array<double, 3> colour = {0.8, 0.3, 0.5};
    std::vector<double> spectrum(wavelengths.size());
    for (std::size_t w = 0; w < spectrum.size(); ++w) {
        for (std::size_t c = 0; c < 3; ++c) spectrum[w] += colour[c] * basis[c][w];
        // White is flat: all three together are 1.
        CHECK(basis[0][w] + basis[1][w] + basis[2][w] == Approx(1.0).margin(1e-3));
    }
    const Image rgb = to_linear_srgb(one_pixel(spectrum), wavelengths);
    for (std::size_t c = 0; c < 3; ++c)
        CHECK(double(rgb.values[c]) == Approx(colour[c]).margin(1e-5));
}

TEST_CASE("three descending wavelengths are red, green and blue themselves", "[render][colour]") {
    const std::vector<double> rgb_nm = {620.0, 535.0, 480.0};
    REQUIRE(is_rgb(rgb_nm));
    CHECK_FALSE(is_rgb({480.0, 535.0, 620.0}));
    CHECK(to_linear_srgb(one_pixel({0.1, 0.2, 0.3}), rgb_nm).values ==
          std::vector{0.1F, 0.2F, 0.3F});
}

TEST_CASE("unknown spectra of light are refused", "[render][colour][errors]") {
    CHECK_THROWS_WITH(light_spectrum("sunny", {550.0}),
                      Catch::Contains("sunny") && Catch::Contains("blackbody"));
    CHECK_THROWS_WITH(light_spectrum("blackbody:5", {550.0}), Catch::Contains("500 to 40000"));
}
