#include "pipeline/plot/axis.h"

#include <cmath>

#include "pipeline/plot/colour_map.h"
#include "tests/support/catch.h"

using namespace miebrdf::plot;

namespace {

std::vector<std::string> labels(const Axis& axis) {
    std::vector<std::string> list;
    for (const Tick& tick : axis.ticks()) {
        if (!tick.label.empty()) list.push_back(tick.label);
    }
    return list;
}

}  // namespace

TEST_CASE("a linear axis is rounded outwards to numbers that people would choose", "[plot][axis]") {
    const Axis axis({"albedo"}, {0.13, 0.71, 0.4});
    CHECK(axis.lowest() == 0.0);
    CHECK(axis.highest() == Approx(0.8).epsilon(1e-15));
    CHECK(labels(axis) == std::vector<std::string>{"0", "0.2", "0.4", "0.6", "0.8"});
    CHECK(axis.position(0.4) == Approx(0.5).epsilon(1e-15));
    CHECK(axis.position(0.8) == 1.0);

    AxisOptions angles{"angle"};
    angles.lowest = 0, angles.highest = 180, angles.step = 30;
    CHECK(labels(Axis(angles, {})) ==
          std::vector<std::string>{"0", "30", "60", "90", "120", "150", "180"});
    // Rounding must not add a step: 0.7 / 0.1 is 6.999...
    CHECK(Axis({"x"}, {0.0, 0.1 * 7}).highest() == Approx(0.8).epsilon(1e-12));
    CHECK(labels(Axis({"x"}, {-1e-5, 1e-5})).size() >= 3);
}

TEST_CASE("a logarithmic axis ends at powers of ten and ignores what it cannot show",
          "[plot][axis]") {
    const Axis axis({"P", Scale::logarithmic}, {0.02, 300, 0, -5, std::nan("")});
    CHECK(axis.lowest() == Approx(0.01).epsilon(1e-12));
    CHECK(axis.highest() == Approx(1000).epsilon(1e-12));
    CHECK(labels(axis) == std::vector<std::string>{"0.01", "0.1", "1", "10", "100", "1000"});
    CHECK(axis.position(1) == Approx(0.4).epsilon(1e-12));
    CHECK(!std::isfinite(axis.position(0)));
    CHECK(!std::isfinite(axis.position(-1)));

    const Axis wide({"k", Scale::logarithmic}, {1e-12, 1e3});
    CHECK(labels(wide).size() <= 9);
    CHECK(labels(wide).front() == "10\u207b\u00b9\u00b2");
    const Axis narrow({"n", Scale::logarithmic}, {2.0, 7.0});
    CHECK(labels(narrow) == std::vector<std::string>{"2", "3", "4", "5", "6", "7"});
}

TEST_CASE("a constant is shown from zero, not as a small change", "[plot][axis]") {
    const Axis constant({"g"}, {0.75, 0.75});
    CHECK(constant.position(0.0) == Approx(0.0).margin(1e-12));
    CHECK(constant.position(0.75) == Approx(0.75).margin(0.15));
    CHECK(Axis({"g"}, {-0.75}).position(0.0) == Approx(1.0));
    CHECK(Axis({"g"}, {0.0}).position(0.0) == Approx(0.0).margin(1e-12));
    const Axis log({"P", Scale::logarithmic}, {3.0});
    CHECK(log.position(3.0) == Approx(0.5).epsilon(1e-12));
}

TEST_CASE("an axis refuses what it cannot show", "[plot][axis][errors]") {
    CHECK_THROWS_WITH(Axis({"albedo"}, {}),
                      Catch::Contains("albedo") && Catch::Contains("no value"));
    CHECK_THROWS_WITH(Axis({"k", Scale::logarithmic}, {0, 0}),
                      Catch::Contains("no positive value"));
    AxisOptions backwards{"x"};
    backwards.lowest = 2, backwards.highest = 1;
    CHECK_THROWS_WITH(Axis(backwards, {}), Catch::Contains("ascending"));
    AxisOptions negative{"x", Scale::logarithmic};
    negative.lowest = -1, negative.highest = 1;
    CHECK_THROWS_WITH(Axis(negative, {}), Catch::Contains("positive"));
}

TEST_CASE("colours are the published ones and rise in lightness", "[plot][palette]") {
    CHECK(curve_colour(1) == "#0072b2");  // Okabe & Ito 2008: blue (0, 114, 178)
    CHECK(curve_colour(2) == "#d55e00");
    CHECK(curve_colour(8) == curve_colour(1));
    CHECK(curve_dash(8) != curve_dash(1));
    CHECK(map_colour(0) == "#440154");
    CHECK(map_colour(1) == "#fde725");
    CHECK(map_colour(7) == map_colour(1));
    CHECK(map_colour(std::nan("")) == kNoValueColour);
    double before = -1;
    for (int i = 0; i <= 20; ++i) {
        const std::string c = map_colour(i / 20.0);
        const auto channel = [&](int at) { return std::stoi(c.substr(at, 2), nullptr, 16); };
        const double luma = 0.2126 * channel(1) + 0.7152 * channel(3) + 0.0722 * channel(5);
        CHECK(luma > before);
        before = luma;
    }
}

TEST_CASE("a logarithmic axis with one power of ten numbers 2 and 5 as well", "[plot][axis]") {
    std::vector<std::string> labels;
    const Axis axis({"y", Scale::logarithmic, 0.3, 9.0}, {1.0});
    for (const Tick& tick : axis.ticks())
        if (!tick.label.empty()) labels.push_back(tick.label);
    CHECK(labels == std::vector<std::string>{"0.5", "1", "2", "5"});
}
