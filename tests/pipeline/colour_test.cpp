#include <miebrdf/colour.h>
#include <miebrdf/error.h>

#include <array>
#include <cmath>

#include "tests/support/catch.h"
#include "tests/support/spectra.h"

using namespace miebrdf;
using support::sample;

namespace {

double largest_difference(const Xyz& a, const Xyz& b) {
    return std::max({std::abs(a.x - b.x), std::abs(a.y - b.y), std::abs(a.z - b.z)});
}

}  // namespace

TEST_CASE("the observer's table has the published sums and peaks", "[colour]") {
    // Wyszecki & Stiles 1982, table I(3.3.1), and CIE 15:2004, table T.4: sums at 5 nm, 380 to 780
    // nm.
    double x = 0, y = 0, z = 0;
    for (int nm = 380; nm <= 780; nm += 5) {
        const ColourMatching c = colour_matching(nm);
        x += c.x, y += c.y, z += c.z;
    }
    CHECK(x == Approx(21.371524).margin(2e-6));  // 81 rows of six decimals
    CHECK(y == Approx(21.371327).margin(2e-6));
    CHECK(z == Approx(21.371540).margin(2e-6));
    CHECK(colour_matching(555).y == 1.0);
    // Sums of the 1 nm table of ISO/CIE 11664-1; cubic interpolation adds up to 1.2e-4.
    x = y = z = 0;
    for (int nm = 360; nm <= 830; ++nm) {
        const ColourMatching c = colour_matching(nm);
        x += c.x, y += c.y, z += c.z;
    }
    CHECK(x == Approx(106.865469).margin(2e-4));
    CHECK(y == Approx(106.856917).margin(2e-4));
    CHECK(z == Approx(106.892251).margin(2e-4));
    CHECK(colour_matching(359.9).y == 0);
    CHECK(colour_matching(831).x == 0);
}

TEST_CASE("illuminants are those of the CIE's tables", "[colour]") {
    // D65 of ISO 11664-2 at 5 nm (six digits): a different table from the S0, S1, S2 it is made of.
    const std::pair<double, double> d65[] = {{360, 46.6383}, {385, 52.3118}, {400, 82.7549},
                                             {435, 95.7736}, {460, 117.812}, {515, 106.296},
                                             {555, 102.023}, {560, 100.0},   {600, 90.0062},
                                             {685, 74.0027}, {720, 61.604},  {830, 60.3125}};
    for (const auto& [nm, power] : d65) {
        CAPTURE(nm);
        CHECK(relative_power(Illuminant::d65, nm) == Approx(power).margin(6e-4));
    }
    // A of the same standard.
    CHECK(relative_power(Illuminant::a, 380) == Approx(9.79510).margin(6e-6));
    CHECK(relative_power(Illuminant::a, 560) == Approx(100.0).epsilon(1e-14));
    CHECK(relative_power(Illuminant::a, 780) == Approx(241.675).margin(6e-4));
    CHECK(relative_power(Illuminant::e, 400) == 100);
    CHECK_THROWS_WITH(relative_power(Illuminant::d65, 900), Catch::Contains("900"));
}

TEST_CASE("white points have the published chromaticities", "[colour]") {
    // CIE 15:2004, table 3 (2-degree observer); five decimals, 1 nm against the table's 5 nm.
    const auto check = [](Illuminant illuminant, double x, double y, double bound) {
        const Xyz w = white_point(illuminant);
        const double sum = w.x + w.y + w.z;
        CHECK(w.y == Approx(1.0).epsilon(1e-14));
        CHECK(std::abs(w.x / sum - x) <= bound);
        CHECK(std::abs(w.y / sum - y) <= bound);
    };
    check(Illuminant::d65, 0.31272, 0.32903, 1.5e-5);
    check(Illuminant::a, 0.44758, 0.40745, 1.5e-5);
    // 1/3 to the closure of the observer's own table (z beyond 380 nm: 3e-4 of the sum).
    check(Illuminant::e, 1.0 / 3, 1.0 / 3, 8e-5);
}

TEST_CASE("a white reflector is white and a grey one grey under every illuminant", "[colour]") {
    const auto illuminant = GENERATE(Illuminant::d65, Illuminant::e, Illuminant::a);
    const auto wavelengths = support::every_nm(5, 360, 830);
    const auto weights = observer_weights(wavelengths, illuminant);
    for (const double grey : {1.0, 0.18}) {
        const auto rgb = to_linear_srgb(
            to_xyz(weights, std::vector<double>(wavelengths.size(), grey)), illuminant);
        CHECK(rgb.red == Approx(grey).epsilon(1e-12));
        CHECK(rgb.green == Approx(grey).epsilon(1e-12));
        CHECK(rgb.blue == Approx(grey).epsilon(1e-12));
    }
    CHECK(to_srgb8({1, 1, 1}) == std::array<std::uint8_t, 3>{255, 255, 255});
    CHECK(to_srgb8({-0.2, 0.18, 7}) == std::array<std::uint8_t, 3>{0, 118, 255});
}

TEST_CASE("the matrix of sRGB is the published one", "[colour]") {
    // IEC 61966-2-1:1999 to its four decimals; red's XYZ goes to (1, 0, 0) through our white.
    const double published[3][3] = {
        {3.2406, -1.5372, -0.4986}, {-0.9689, 1.8758, 0.0415}, {0.0557, -0.2040, 1.0570}};
    const Xyz units[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    for (int column = 0; column < 3; ++column) {
        const LinearSrgb rgb = to_linear_srgb(units[column]);
        // Our integrated D65 differs from (0.3127, 0.3290) by 3e-5, which Bradford takes out.
        CHECK(rgb.red == Approx(published[0][column]).margin(6e-4));
        CHECK(rgb.green == Approx(published[1][column]).margin(6e-4));
        CHECK(rgb.blue == Approx(published[2][column]).margin(6e-4));
    }
}

TEST_CASE("ACEScg is linear sRGB by the published matrix", "[colour]") {
    // Adaptation by Bradford; the ACES implementation's six decimals.
    const double published[3][3] = {{0.613097, 0.339523, 0.047380},
                                    {0.070194, 0.916354, 0.013452},
                                    {0.020616, 0.109570, 0.869815}};
    for (const Illuminant light : {Illuminant::d65, Illuminant::a}) {
        for (const Xyz& xyz : {Xyz{1, 0, 0}, Xyz{0, 1, 0}, Xyz{0, 0, 1}, white_point(light)}) {
            const LinearSrgb rgb = to_linear_srgb(xyz, light);
            const std::array<double, 3> aces = to_acescg(xyz, light);
            for (std::size_t row = 0; row < 3; ++row) {
                const double* m = published[row];
                CHECK(std::abs(aces[row] - (m[0] * rgb.red + m[1] * rgb.green + m[2] * rgb.blue)) <=
                      2e-5);
            }
        }
    }
    for (const double one : to_acescg(white_point(Illuminant::d50), Illuminant::d50))
        CHECK(std::abs(one - 1) <= 1e-12);
}

TEST_CASE("encoding is that of IEC 61966-2-1 and its own inverse", "[colour]") {
    CHECK(encode_srgb(0) == 0);
    CHECK(encode_srgb(1) == Approx(1).epsilon(1e-15));
    CHECK(encode_srgb(0.001) == Approx(0.01292).epsilon(1e-14));
    CHECK(encode_srgb(0.21404114048223255) ==
          Approx(0.5).epsilon(1e-14));  // ((0.5 + a) / (1 + a))^2.4
    const auto decoded = [](double v) {
        const double size = std::abs(v);
        return std::copysign(size <= 0.04045 ? size / 12.92 : std::pow((size + 0.055) / 1.055, 2.4),
                             v);
    };
    for (int i = -100; i <= 150; ++i) {
        const double v = 0.01 * i;
        CAPTURE(v);
        CHECK(std::abs(decoded(encode_srgb(v)) - v) <= 1e-7);
    }
    // 1e-7: the two branches as standardised meet with a step of 3e-8.
}

TEST_CASE("weights integrate what is linear between the wavelengths exactly", "[colour]") {
    const std::vector<double> few{400, 450, 500, 600, 700};
    const auto fine = support::every_nm(5, 360, 830);
    const auto kinked = [](double nm) {
        return nm < 500 ? 0.2 + (nm - 400) * 1e-3 : 0.3 + (nm - 500) * 2e-3;
    };
    const auto clamped = [&](double nm) { return kinked(std::min(700.0, std::max(400.0, nm))); };
    const Xyz coarse = to_xyz(observer_weights(few), sample(few, kinked));
    const Xyz exact = to_xyz(observer_weights(fine), sample(fine, clamped));
    CHECK(largest_difference(coarse, exact) <= 1e-14);
}

TEST_CASE("colours of known spectra", "[colour]") {
    // Monochromatic light at 520 and 610 nm lies on the spectrum locus: (0.07430, 0.83380) and
    // (0.66577, 0.33401), CIE 15:2004, table T.4. A spike of 1 nm half-width stands for it.
    const auto locus = [](double nm) {
        const auto weights = observer_weights({nm - 1, nm, nm + 1}, Illuminant::e);
        return to_xyz(weights, {0, 1, 0});
    };
    const Xyz green = locus(520), red = locus(610);
    CHECK(green.x / (green.x + green.y + green.z) == Approx(0.07430).margin(6e-6));
    CHECK(green.y / (green.x + green.y + green.z) == Approx(0.83380).margin(6e-6));
    CHECK(red.x / (red.x + red.y + red.z) == Approx(0.66577).margin(1e-5));
    CHECK(red.y / (red.x + red.y + red.z) == Approx(0.33401).margin(1e-5));
}

TEST_CASE("colour refuses what has none", "[colour][errors]") {
    CHECK_THROWS_WITH(observer_weights({}), Catch::Contains("without wavelengths"));
    CHECK_THROWS_WITH(observer_weights({500, 450}),
                      Catch::Contains("450") && Catch::Contains("ascend"));
    CHECK_THROWS_WITH(to_xyz(observer_weights({500, 550}), {1}),
                      Catch::Contains("1 reflectances for 2"));
}

TEST_CASE("Lab: white, greys in closed form, and the published values of sRGB red",
          "[pipeline][colour]") {
    for (const Illuminant illuminant : {Illuminant::d65, Illuminant::a, Illuminant::e}) {
        const Xyz white = white_point(illuminant);
        const Lab lab = to_lab(white, illuminant);
        CHECK(std::abs(lab.l - 100) <= 1e-12);
        CHECK(std::abs(lab.a) <= 1e-12);
        CHECK(std::abs(lab.b) <= 1e-12);
        // L = 116 Y^(1/3) - 16 above (6/29)^3, (29/3)^3 Y below (ISO/CIE 11664-4).
        const auto grey = [&](double y) {
            return to_lab({y * white.x, y * white.y, y * white.z}, illuminant);
        };
        CHECK(std::abs(grey(std::pow(66.0 / 116, 3)).l - 50) <= 1e-12);
        CHECK(std::abs(grey(0.001).l - 24.389 / 27) <= 1e-12);
        CHECK(std::abs(grey(0.001).a) <= 1e-12);
    }
    // sRGB red has L, a, b = 53.24, 80.09, 67.20 for the rounded white 0.95047, 1, 1.08883.
    const Lab red = to_lab({0.4124564, 0.2126729, 0.0193339});
    CHECK(std::abs(red.l - 53.24) <= 0.01);
    CHECK(std::abs(red.a - 80.09) <= 0.02);
    CHECK(std::abs(red.b - 67.20) <= 0.02);
}

TEST_CASE("colours refuse lists that do not fit, as errors of this library", "[colour][errors]") {
    const double nan = std::nan("");
    CHECK_THROWS_AS(observer_weights({}), UsageError);
    CHECK_THROWS_AS(observer_weights({400, nan, 700}), UsageError);
    CHECK_THROWS_AS(relative_power(Illuminant::d65, nan), UsageError);
    CHECK_THROWS_AS(to_xyz(observer_weights({400, 700}), {1.0}), UsageError);
    CHECK_THROWS_AS(Colorimeter({400, 700}), UsageError);
    CHECK(to_srgb8({nan, 1.0, 2.0}) == std::array<std::uint8_t, 3>{0, 255, 255});
}
