#include "pipeline/plot/chart.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "pipeline/plot/colour_map.h"
#include "pipeline/plot/spectra.h"
#include "tests/plot/svg_text.h"
#include "tests/support/catch.h"

using namespace miebrdf;
using namespace miebrdf::plot;

namespace {

bool contains(const std::vector<std::string>& list, const std::string& wanted) {
    return std::find(list.begin(), list.end(), wanted) != list.end();
}

}  // namespace

TEST_CASE("a curve's points lie where its axes say", "[plot][chart]") {
    Panel panel{{"x"}, {"y"}, {{"curve", {0, 1, 4}, {0, 10, 5}}}};
    const Picture picture = draw_chart({panel}, {"title", "command"});
    const auto lines = support::attributes(picture.svg, "polyline", "points");
    REQUIRE(lines.size() == 1);
    const auto at = support::points(lines[0]);
    REQUIRE(at.size() == 3);
    // Linear axes: equal ratios, to the two decimals that are written.
    CHECK((at[1].first - at[0].first) / (at[2].first - at[0].first) == Approx(0.25).margin(1e-4));
    CHECK((at[2].second - at[0].second) / (at[1].second - at[0].second) ==
          Approx(0.5).margin(1e-4));
    CHECK(at[1].second < at[0].second);  // larger is higher up
}

TEST_CASE("names stand beside their points and cover nothing", "[plot][chart]") {
    Curve curve{"", {0, 1, 1, 2}, {0, 1, 1, 2}, Mark::line_and_points};
    Panel panel{{"x"}, {"y"}, {curve}};
    // The second and the third point are one: there is room for some of ten names about it.
    for (int i = 0; i < 10; ++i) panel.names.push_back({1, 1, "name " + std::to_string(i)});
    panel.names.push_back({2, 2, "at the corner"});
    const Picture picture = draw_chart({panel}, {});
    CHECK(picture.svg.find(">name 0<") != std::string::npos);
    CHECK(picture.svg.find(">name 9<") == std::string::npos);
    CHECK(picture.svg.find(">at the corner<") != std::string::npos);
}

TEST_CASE("a line breaks at values that do not exist", "[plot][chart]") {
    const double gap = std::nan("");
    Panel panel{
        {"x"}, {"y", Scale::logarithmic}, {{"", {0, 1, 2, 3, 4, 5, 6}, {1, 2, gap, 3, 4, 0, 5}}}};
    const Picture picture = draw_chart({panel}, {});
    // Two runs of two points, and a lone point as a circle.
    CHECK(support::attributes(picture.svg, "polyline", "points").size() == 2);
    CHECK(support::attributes(picture.svg, "circle", "r").size() == 1);
}

TEST_CASE("titles, units and legends are on the page, the command in the file", "[plot][chart]") {
    const std::vector<double> nm{400, 500, 600};
    const Picture picture =
        draw_spectrum({{"spherical", nm, {0.1, 0.2, 0.3}, LinearSrgb{1, 0, 0}},
                       {"plane", nm, {0.2, 0.3, 0.4}, {}}},
                      "albedo", {"A < B & \"C\"", "miebrdf albedo --base 'a&b'"});
    CHECK(support::is_well_formed(picture.svg));
    const auto texts = support::texts(picture.svg);
    for (const char* wanted : {"A &lt; B &amp; &quot;C&quot;", "albedo", "vacuum wavelength [nm]",
                               "spherical", "plane"}) {
        CAPTURE(wanted);
        CHECK(contains(texts, wanted));
    }
    CHECK(picture.svg.find("<desc>miebrdf albedo --base &#39;a&amp;b&#39;</desc>") !=
          std::string::npos);
    CHECK(contains(support::attributes(picture.svg, "rect", "fill"), "#ff0000"));
    CHECK(picture.svg == draw_spectrum({{"spherical", nm, {0.1, 0.2, 0.3}, LinearSrgb{1, 0, 0}},
                                        {"plane", nm, {0.2, 0.3, 0.4}, {}}},
                                       "albedo", {"A < B & \"C\"", "miebrdf albedo --base 'a&b'"})
                             .svg);
}

TEST_CASE("a material without absorption is said to have none", "[plot][chart]") {
    const std::vector<double> nm{400, 700};
    const Picture both =
        draw_nk({{"SiO2", nm, {1.47, 1.45}, {0, 0}}, {"GaP", nm, {3.5, 3.3}, {0.1, 0.001}}}, {});
    CHECK(contains(support::texts(both.svg), "SiO2 (k = 0)"));
    CHECK(contains(support::texts(both.svg), "k"));
    CHECK(support::attributes(both.svg, "polyline", "points").size() == 3);
    const Picture one = draw_nk({{"SiO2", nm, {1.47, 1.45}, {0, 0}}}, {});
    CHECK(one.height < both.height);
    CHECK(!contains(support::texts(one.svg), "k"));
}

TEST_CASE("a chart refuses curves that do not fit", "[plot][chart][errors]") {
    CHECK_THROWS_WITH(draw_chart({}, {}), Catch::Contains("without panels"));
    CHECK_THROWS_WITH(draw_chart({{{"x"}, {"albedo"}, {}}}, {}), Catch::Contains("albedo"));
    CHECK_THROWS_WITH(draw_chart({{{"x"}, {"y"}, {{"c", {1, 2}, {1}}}}}, {}),
                      Catch::Contains("2 x for 1 y"));
    CHECK_THROWS_WITH(draw_spectrum({{"s", {400, 500}, {0, 0}, {}}}, "P", {}, Scale::logarithmic),
                      Catch::Contains("no positive value"));
}

TEST_CASE("long titles and legends stay on the page", "[plot][chart]") {
    const std::string title =
        "TiO2, radius 0.13 um, 15 % of the volume in PMMA (40 um) on ground of albedo 0.8, "
        "roughness 0.3, 550 nm, azimuth 180 degrees";
    Panel panel{{"x"}, {"y"}, {{title, {0, 1}, {0, 1}}, {"short", {0, 1}, {1, 0}}}};
    const Picture picture = draw_chart({panel}, {title, ""});
    CHECK(support::is_well_formed(picture.svg));
    std::size_t lines = 0;
    for (const std::string& text : support::texts(picture.svg)) {
        CAPTURE(text);
        // At the size of the legend, the smaller of the two.
        CHECK(SvgDrawing::text_width(text, 12) <= picture.width);
        if (text.find("TiO2") != std::string::npos || text.find("azimuth") != std::string::npos)
            ++lines;
    }
    CHECK(lines >= 4);  // two or more of the title, as many of the legend
    CHECK(draw_chart({panel}, {}).height < picture.height);
}

TEST_CASE("members of a family go from dark to light", "[plot][chart]") {
    Panel panel{{"x"},
                {"y"},
                {{"a", {0, 1}, {0, 1}, Mark::line, {}, {}, 0.0},
                 {"b", {0, 1}, {0, 2}, Mark::line, {}, {}, 1.0}}};
    const auto strokes = support::attributes(draw_chart({panel}, {}).svg, "polyline", "stroke");
    REQUIRE(strokes.size() == 2);
    CHECK(strokes[0] == map_colour(0.0));
    CHECK(strokes[1] == map_colour(0.88));
}
