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
    map.zenith_edges_deg = {0, 45, 90};
    map.azimuth_edges_deg = {0, 90, 180};
    map.value = {0, 0, 1, 0.5};  // bright at the rim on the mirror side
    map.incidence_deg = 30;
    const Picture picture = draw_hemisphere(map, {"h", "c"});
    CHECK(support::is_well_formed(picture.svg));
    const auto fills = support::attributes(picture.svg, "path", "fill");
    const auto shapes = support::attributes(picture.svg, "path", "d");
    REQUIRE(fills.size() == 3);
    const auto paths = support::starts(
        shapes[std::size_t(std::find(fills.begin(), fills.end(), "#fde725") - fills.begin())]);
    REQUIRE(paths.size() == 1);
    // A cell starts at the rim of its first azimuth, here 0: on the right, as high as the centre.
    const auto bounds = support::attributes(picture.svg, "circle", "cy");
    CHECK(fmt::format("{:.2f}", paths[0].second) == bounds.front());
    CHECK(paths[0].first > 0.5 * picture.width);
    const auto images = support::attributes(picture.svg, "use", "transform");
    CHECK(images == std::vector{fmt::format("matrix(1 0 0 -1 0 {:.2f})", 2 * paths[0].second)});
}

TEST_CASE("a slice puts each value in its place, merges equal neighbours and greys what is not",
          "[plot][slice]") {
    SliceMap map;
    map.half_cells = 3, map.difference_cells = 2;
    map.value = {1, 1, 10, 100, 100, std::nan("")};
    const Picture picture = draw_slice(map, {});
    CHECK(support::is_well_formed(picture.svg));
    const auto fills = support::attributes(picture.svg, "path", "fill");
    const auto shapes = support::attributes(picture.svg, "path", "d");
    REQUIRE(fills.size() == 4);
    const auto start_of = [&](const std::string& colour) {
        const auto at = std::find(fills.begin(), fills.end(), colour) - fills.begin();
        REQUIRE(std::size_t(at) < fills.size());
        const auto starts = support::starts(shapes[std::size_t(at)]);
        REQUIRE(starts.size() == 1);
        return starts.front();
    };
    // theta_h to the right, theta_d upwards; corners are written with two decimals.
    const auto low = start_of("#440154"), high = start_of("#fde725"), none = start_of("#c8c8c8");
    CHECK(low.first == Approx(high.first).margin(0.011));
    CHECK(low.second > high.second);
    CHECK(none.first > high.first);
    CHECK(none.second == Approx(high.second).margin(0.011));
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

TEST_CASE("a map of thousands of cells stays small", "[plot][hemisphere][slice]") {
    SliceMap slice;
    slice.half_cells = slice.difference_cells = 90;
    HemisphereMap hemisphere;
    for (int i = 0; i <= 45; ++i) hemisphere.zenith_edges_deg.push_back(2.0 * i);
    for (int i = 0; i <= 60; ++i) hemisphere.azimuth_edges_deg.push_back(3.0 * i);
    // Every cell differs from its neighbours: nothing can be merged.
    for (int i = 0; i < 90 * 90; ++i) slice.value.push_back(1 + 37 * i % 256);
    for (int i = 0; i < 45 * 60; ++i) hemisphere.value.push_back(37 * i % 256);
    CHECK(draw_slice(slice, {}).svg.size() < 300000);
    CHECK(draw_hemisphere(hemisphere, {}).svg.size() < 300000);
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
    map.zenith_edges_deg = {0, 95};
    map.azimuth_edges_deg = {0, 180};
    map.value = {1};
    CHECK_THROWS_WITH(draw_hemisphere(map, {}), Catch::Contains("zenith"));
}
