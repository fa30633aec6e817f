#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "pipeline/plot/hemisphere.h"
#include "pipeline/plot/lobe.h"
#include "pipeline/plot/slice.h"
#include "pipeline/plot/spectra.h"
#include "tests/plot/svg_text.h"
#include "tests/support/catch.h"

using namespace miebrdf;
using namespace miebrdf::plot;

namespace {

constexpr double kDegree = std::numbers::pi / 180;

/// The last polyline: curves are drawn after grid and frame.
std::vector<std::pair<double, double>> last_curve(const Picture& picture) {
    return support::points(support::attributes(picture.svg, "polyline", "points").back());
}

}  // namespace

TEST_CASE("a lobe points to the right on the mirror side and is as long as its value",
          "[plot][lobe]") {
    const Picture picture = draw_lobe({{"", {-90, 0, 60, 90}, {2, 4, 4, 1}, 30}}, {}, {"t", "c"});
    CHECK(support::is_well_formed(picture.svg));
    const auto at = last_curve(picture);
    REQUIRE(at.size() == 4);
    const double cx = at[1].first;  // the value at the normal lies above the centre
    const double cy = at[0].second;
    const auto radius = [&](int i) { return std::hypot(at[i].first - cx, at[i].second - cy); };
    CHECK(at[0].first < cx);
    CHECK(at[2].first > cx);
    // Two decimals of some 185 units.
    CHECK(radius(0) / radius(1) == Approx(0.5).margin(1e-4));
    CHECK(radius(2) / radius(1) == Approx(1.0).margin(1e-4));
    CHECK(radius(3) / radius(1) == Approx(0.25).margin(1e-4));
    CHECK(std::atan2(at[2].first - cx, cy - at[2].second) ==
          Approx(std::acos(-1) / 3).margin(1e-4));
}

TEST_CASE("a logarithmic lobe puts a decade at equal distances and the rest in the centre",
          "[plot][lobe]") {
    const Picture picture = draw_lobe({{"", {-90, -60, 0, 90}, {1, 10, 0.1, 1e-6}, 0}},
                                      {.logarithmic = true, .decades = 3}, {});
    const auto at = last_curve(picture);
    const double cx = at[2].first, cy = at[0].second;
    const auto radius = [&](int i) { return std::hypot(at[i].first - cx, at[i].second - cy); };
    CHECK(radius(0) / radius(1) == Approx(2.0 / 3).margin(1e-4));
    CHECK(radius(2) / radius(1) == Approx(1.0 / 3).margin(1e-4));
    CHECK(radius(3) == Approx(0).margin(0.02));
}

TEST_CASE("a lobe in fine steps keeps every bend and leaves out what lies on a line",
          "[plot][lobe]") {
    // A bow a degree wide on a matt ground, as fine as `plot lobe` computes it.
    LobeCurve curve{"", {}, {}, 0};
    for (int i = -716; i <= 716; ++i) {
        curve.angle_deg.push_back(0.125 * i);
        curve.value.push_back(1 + 0.3 * std::exp(-std::pow((0.125 * i - 40) / 0.5, 2)));
    }
    const auto at = last_curve(draw_lobe({curve}, {}, {}));
    CHECK(at.size() < curve.value.size() / 4);
    REQUIRE(at.size() > 20);
    // The ends have value 1: centre and scale of the radius, which is linear from 0.
    const double rim = 89.5 * kDegree;
    const double unit = 0.5 * (at.back().first - at.front().first) / std::sin(rim);
    const double cx = 0.5 * (at.front().first + at.back().first);
    const double cy = at.front().second + unit * std::cos(rim);
    double farthest = 0;
    for (std::size_t i = 0; i < curve.value.size(); ++i) {
        const double angle = curve.angle_deg[i] * kDegree, radius = unit * curve.value[i];
        const double x = cx + radius * std::sin(angle), y = cy - radius * std::cos(angle);
        double nearest = 1e9;
        for (std::size_t k = 1; k < at.size(); ++k) {
            const double dx = at[k].first - at[k - 1].first, dy = at[k].second - at[k - 1].second;
            const double along =
                ((x - at[k - 1].first) * dx + (y - at[k - 1].second) * dy) / (dx * dx + dy * dy);
            const double t = std::clamp(along, 0.0, 1.0);
            nearest = std::min(
                nearest, std::hypot(x - at[k - 1].first - t * dx, y - at[k - 1].second - t * dy));
        }
        farthest = std::max(farthest, nearest);
    }
    // Points that are left out are 0.03 from the line at most; two decimals, also in centre and
    // scale.
    CHECK(farthest <= 0.03 + 0.02);
}

TEST_CASE("a phase function is drawn on both sides of the light's axis", "[plot][phase]") {
    const Picture picture = draw_phase_polar({{"P", {0, 90, 180}, {100, 1, 10}}}, {}, 4);
    const auto lower = last_curve(picture);
    const auto all = support::attributes(picture.svg, "polyline", "points");
    const auto upper = support::points(all[all.size() - 2]);
    REQUIRE(lower.size() == 3);
    CHECK(upper[0] == lower[0]);  // forward, to the right
    CHECK(upper[0].first > upper[2].first);
    CHECK(upper[1].second < lower[1].second);
    CHECK(upper[1].second + lower[1].second == Approx(2 * upper[0].second).margin(0.03));
}

TEST_CASE("a hemisphere shows each value in its place and mirrors a half", "[plot][hemisphere]") {
    HemisphereMap map;
    map.size = 60;
    map.value.assign(60 * 30, 0.0);
    map.incidence_deg = 30;
    // Bright towards the rim on the mirror side, just above the axis.
    map.value[29 * 60 + 57] = 1.0;
    const PixelMap pixels = pixels_of(map, Axis({"v"}, map.value));
    CHECK(pixels.at(57, 29) == PixelMap::kPixelColours - 1);
    CHECK(pixels.at(57, 30) == PixelMap::kPixelColours - 1);
    CHECK(pixels.at(1, 29) == 0);
    CHECK(pixels.at(0, 0) == PixelMap::kNothing);  // a corner is outside the disk
    const auto angles = pixel_angles(60, 58, 29);
    REQUIRE(angles);
    // 28.5 and 0.5 pixels of 30 from the centre.
    CHECK(angles->zenith_deg == Approx(90 * std::hypot(28.5, 0.5) / 30).epsilon(1e-12));
    CHECK(angles->azimuth_deg == Approx(std::atan2(0.5, 28.5) / kDegree).epsilon(1e-12));
    CHECK_FALSE(pixel_angles(60, 0, 0));
    const Picture picture = draw_hemisphere(map, {"h", "c"});
    CHECK(support::is_well_formed(picture.svg));
    CHECK(support::attributes(picture.svg, "image", "width") == std::vector<std::string>{"290.00"});
}

TEST_CASE("a slice puts each value in its place and greys what is not", "[plot][slice]") {
    SliceMap map;
    map.half_cells = 3, map.difference_cells = 2;
    map.value = {1, 1, 10, 100, 100, std::nan("")};
    const PixelMap pixels = pixels_of(map, Axis({"v", Scale::logarithmic}, map.value));
    // 290 pixels for a cell along theta_h, 435 along theta_d; theta_h to the right, theta_d up.
    CHECK(pixels.at(0, 869) == 0);
    CHECK(pixels.at(579, 435) == 0);
    CHECK(pixels.at(580, 435) == std::lround(0.5 * (PixelMap::kPixelColours - 1)));
    CHECK(pixels.at(0, 434) == PixelMap::kPixelColours - 1);
    CHECK(pixels.at(869, 0) == PixelMap::kNoValue);
    CHECK(support::is_well_formed(draw_slice(map, {}).svg));
}

TEST_CASE("an image of values is a PNG file with a palette", "[plot]") {
    PixelMap pixels(3, 2);
    pixels.set(0, 0, Axis({"v"}, {0, 1}), 1.0);
    const std::string png = pixels.png();
    CHECK(png.substr(1, 3) == "PNG");
    CHECK(png.substr(12, 4) == "IHDR");
    CHECK(png.substr(16, 8) == std::string("\0\0\0\3\0\0\0\2", 8));
    // Every chunk carries the sum of its bytes; that has its own test.
    std::size_t chunks = 0;
    for (std::size_t at = 8; at < png.size(); ++chunks) {
        const auto word = [&](std::size_t place) {
            std::uint32_t value = 0;
            for (std::size_t i = 0; i < 4; ++i)
                value = value << 8 | static_cast<unsigned char>(png.at(place + i));
            return value;
        };
        const std::size_t length = word(at);
        CHECK(png.substr(at, 12 + length) ==
              png_chunk(png.substr(at + 4, 4), png.substr(at + 8, length)));
        at += 12 + length;
    }
    CHECK(chunks == 5);
    CHECK_THROWS_AS(PixelMap(0, 2), std::invalid_argument);
}

TEST_CASE("at azimuth 90 both directions of a slice are as steep", "[plot][slice]") {
    for (const double h : {0.5, 20.0, 89.5}) {
        for (const double d : {0.5, 45.0, 89.5}) {
            const auto direction = slice_direction(h, d, 90.0);
            REQUIRE(direction);
            const double expected = std::cos(h * kDegree) * std::cos(d * kDegree);
            CHECK(direction->mu_in == Approx(expected).epsilon(1e-12).margin(1e-15));
            CHECK(direction->mu_out == Approx(expected).epsilon(1e-12).margin(1e-15));
        }
    }
}

TEST_CASE("a slice's directions have its half and difference angles", "[plot][slice]") {
    // From the cosines back: the law of cosines gives the angle between light and view, 2 theta_d,
    // and the half vector's cosine is (mu_in + mu_out) / (2 cos theta_d). Rounding only.
    const double h = GENERATE(3.0, 30.0, 61.0), d = GENERATE(2.0, 25.0, 50.0);
    const double phi = GENERATE(0.0, 40.0, 90.0, 180.0);
    const auto direction = slice_direction(h, d, phi);
    const double lower =
        std::cos(h * kDegree) * std::cos(d * kDegree) -
        std::sin(h * kDegree) * std::sin(d * kDegree) * std::abs(std::cos(phi * kDegree));
    CAPTURE(h, d, phi, lower);
    REQUIRE(direction.has_value() == (lower > 0));
    if (!direction) return;
    const auto [mu_in, mu_out, azimuth] = *direction;
    const double sines = std::sqrt((1 - mu_in * mu_in) * (1 - mu_out * mu_out));
    const double between = mu_in * mu_out - sines * std::cos(azimuth * kDegree);
    CHECK(between == Approx(std::cos(2 * d * kDegree)).margin(1e-12));
    CHECK((mu_in + mu_out) / (2 * std::cos(d * kDegree)) ==
          Approx(std::cos(h * kDegree)).margin(1e-12));
    if (phi < 90) CHECK(mu_in < mu_out);  // the light is the lower of the two
}

TEST_CASE("a map as fine as the page stays small", "[plot][hemisphere]") {
    HemisphereMap map;
    map.size = 870;
    for (int y = 0; y < 435; ++y) {
        for (int x = 0; x < 870; ++x) map.value.push_back(std::sin(0.01 * x) * std::cos(0.02 * y));
    }
    CHECK(draw_hemisphere(map, {}).svg.size() < 400000);
}

TEST_CASE("polar charts refuse data that do not fit", "[plot][errors]") {
    CHECK_THROWS_WITH(draw_lobe({}, {}, {}), Catch::Contains("without curves"));
    CHECK_THROWS_WITH(draw_lobe({{"a", {0, 1}, {1}, 0}}, {}, {}),
                      Catch::Contains("1 values for 2 angles"));
    CHECK_THROWS_WITH(draw_lobe({{"a", {0, 95}, {1, 1}, 0}}, {}, {}), Catch::Contains("95"));
    CHECK_THROWS_WITH(draw_lobe({{"a", {0, 5}, {0, 0}, 0}}, {}, {}), Catch::Contains("positive"));
    CHECK_THROWS_WITH(draw_phase_polar({{"P", {0}, {1}}}, {}, 13), Catch::Contains("0 to 12"));
    CHECK_THROWS_WITH(draw_slice({2, 2, {1, 2, 3}}, {}), Catch::Contains("3 values for 2 x 2"));
    HemisphereMap map;
    map.size = 3;
    CHECK_THROWS_WITH(draw_hemisphere(map, {}), Catch::Contains("even"));
    map.size = 4;
    map.value = {1};
    CHECK_THROWS_WITH(draw_hemisphere(map, {}), Catch::Contains("1 values for 8"));
}
