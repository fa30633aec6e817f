#include <cmath>

#include "pipeline/plot/hemisphere.h"
#include "pipeline/plot/lobe.h"
#include "pipeline/plot/slice.h"
#include "pipeline/plot/spectra.h"
#include "tests/plot/svg_text.h"
#include "tests/support/catch.h"

using namespace miebrdf;
using namespace miebrdf::plot;

namespace {

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
    const auto fills = support::attributes(picture.svg, "polygon", "fill");
    const auto shapes = support::attributes(picture.svg, "polygon", "points");
    REQUIRE(fills.size() == 8);
    int bright = 0;
    for (std::size_t i = 0; i < fills.size(); ++i) {
        if (fills[i] != "#fde725") continue;
        ++bright;
        double x = 0;
        const auto at = support::points(shapes[i]);
        for (const auto& p : at) x += p.first / static_cast<double>(at.size());
        CHECK(x > 0.5 * picture.width * 0.8);  // right of the disk's centre at 191 of 460
    }
    CHECK(bright == 2);
}

TEST_CASE("a slice marks directions that do not exist and merges equal neighbours",
          "[plot][slice]") {
    SliceMap map;
    map.half_cells = 3, map.difference_cells = 2;
    map.value = {1, 1, 10, 100, 100, std::nan("")};
    const Picture picture = draw_slice(map, {});
    const auto fills = support::attributes(picture.svg, "path", "fill");
    CHECK(fills == std::vector<std::string>{"#440154", fills[1], "#fde725", "#c8c8c8"});
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
