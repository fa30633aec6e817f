// Lists, ranges and columns of files.
#include <miebrdf/error.h>

#include <algorithm>
#include <cmath>

#include "pipeline/sweep/axis_values.h"
#include "pipeline/sweep/samples.h"
#include "tests/support/catch.h"
#include "tests/support/temporary_folder.h"

using namespace miebrdf;
using Catch::Contains;

TEST_CASE("ranges of an axis have steps or counts", "[sweep]") {
    CHECK(sweep::parse_axis("x", "0:1:0.25").numbers == std::vector<double>{0, 0.25, 0.5, 0.75, 1});
    CHECK(sweep::parse_axis("x", "0:1:5 linear").numbers ==
          std::vector<double>{0, 0.25, 0.5, 0.75, 1});
    CHECK(sweep::parse_axis("x", "3,1:2:1").numbers == std::vector<double>{3, 1, 2});
    CHECK(sweep::parse_axis("wavelength_nm", "0.5um,600").numbers == std::vector<double>{500, 600});

    const sweep::Axis axis = sweep::parse_axis("radius_um", "50:1000:10 log");
    REQUIRE(axis.size() == 10);
    CHECK(axis.numbers.front() == 50.0);
    CHECK(axis.numbers.back() == 1000.0);
    CHECK(axis.is_logarithmic);
    CHECK(axis.unit == "um");
    for (std::size_t i = 1; i < axis.size(); ++i) {  // twelve digits: 5e-12 each
        const double step = std::log(axis.numbers[i] / axis.numbers[i - 1]);
        CHECK(std::abs(step - std::log(20.0) / 9.0) <= 1e-11);
        CHECK(std::stod(axis.words[i]) == axis.numbers[i]);
    }
}

TEST_CASE("bad ranges are refused with what was allowed", "[sweep][errors]") {
    CHECK_THROWS_WITH(sweep::parse_axis("x", "0:1:3 log"), Contains("not positive"));
    CHECK_THROWS_WITH(sweep::parse_axis("x", "1:2:2.5 log"), Contains("2.5"));
    CHECK_THROWS_WITH(sweep::parse_axis("x", "1:2:3 cubic"), Contains("log, linear"));
    CHECK_THROWS_WITH(sweep::parse_axis("x", "1:2 log"), Contains("first:last:count"));
    CHECK_THROWS_WITH(sweep::parse_axis("x", "1:2:1 log"), Contains("one value"));
    CHECK_THROWS_WITH(sweep::parse_axis("x", "1:2:-1"), Contains("-1"));
    CHECK_THROWS_WITH(sweep::parse_axis("x", "TiO2"), Contains("TiO2") && Contains("list"));
    CHECK_THROWS_AS(sweep::require_monotonic(sweep::axis_of("x", {1, 2, 2})), UsageError);
    CHECK_THROWS_AS(sweep::require_monotonic(sweep::axis_of("x", {1, 3, 2})), UsageError);
    CHECK_NOTHROW(sweep::require_monotonic(sweep::axis_of("x", {3, 2, 1})));
}

TEST_CASE("columns of a CSV file are numbers or texts", "[sweep]") {
    const support::TemporaryFolder folder;
    const std::string file =
        folder.write("samples.csv", "# drawn somewhere\nr,name\n1.5,TiO2\n2e-3,\"ZnO\"\r\n");
    const auto axes = sweep::read_columns(file, {});
    REQUIRE(axes.size() == 2);
    CHECK(axes[0].numbers == std::vector<double>{1.5, 2e-3});
    CHECK(axes[1].is_text());
    CHECK(axes[1].words == std::vector<std::string>{"TiO2", "ZnO"});
    CHECK(sweep::read_columns(file, {"name"}).size() == 1);
    CHECK_THROWS_WITH(sweep::read_columns(file, {"radius"}), Contains("r, name"));
    CHECK_THROWS_WITH(sweep::read_columns(folder.write("b.csv", "a,b\n1\n"), {}),
                      Contains("b.csv:2: "));
    CHECK_THROWS_AS(sweep::read_columns(folder / "none.csv", {}), InputError);
}

TEST_CASE("Sobol's samples begin as published", "[sweep]") {
    // Bratley and Fox 1988, with the origin left out: column 1 is van der Corput's sequence in the
    // order of Gray's code.
    const auto axes = sweep::sobol_samples(7, {{"a"}, {"b"}});
    REQUIRE(axes.size() == 2);
    CHECK(axes[0].numbers == std::vector<double>{0.5, 0.75, 0.25, 0.375, 0.875, 0.625, 0.125});
    CHECK(axes[1].numbers == std::vector<double>{0.5, 0.25, 0.75, 0.375, 0.875, 0.125, 0.625});
    const auto scaled = sweep::sobol_samples(
        3, {sweep::parse_sample_range("r_um", "1:16 log"), sweep::parse_sample_range("x", "-1:1")});
    CHECK(scaled[0].numbers == std::vector<double>{4, 8, 2});
    CHECK(scaled[1].numbers == std::vector<double>{0, -0.5, 0.5});
    CHECK(scaled[0].unit == "um");
}

TEST_CASE("samples fill equal boxes evenly", "[sweep]") {
    // With the origin, 2^k points of Sobol's sequence have one in each of 2^k intervals, in every
    // column, and in two columns one in each of 2^i x 2^j boxes, i + j = k (a (0, k, 2)-net).
    const auto axes = sweep::sobol_samples(255, {{"a"}, {"b"}, {"c"}});
    for (const int rows : {1, 4, 16, 256}) {
        std::vector<int> boxes(256, 0);
        ++boxes[0];  // the origin
        for (std::size_t i = 0; i < 255; ++i) {
            const int row = int(axes[0].numbers[i] * rows);
            const int column = int(axes[1].numbers[i] * (256 / rows));
            ++boxes[std::size_t(row * (256 / rows) + column)];
        }
        CHECK(std::all_of(boxes.begin(), boxes.end(), [](int count) { return count == 1; }));
    }
    // A Latin hypercube has one value in each of its intervals, whatever their number.
    const auto latin = sweep::latin_hypercube_samples(37, {{"a"}, {"b", 0.0, 2.0}}, 5);
    for (std::size_t c = 0; c < 2; ++c) {
        std::vector<int> intervals(37, 0);
        for (const double x : latin[c].numbers) ++intervals[std::size_t(x / double(c + 1) * 37.0)];
        CHECK(std::all_of(intervals.begin(), intervals.end(), [](int n) { return n == 1; }));
        CHECK_FALSE(std::is_sorted(latin[c].numbers.begin(), latin[c].numbers.end()));
    }
    CHECK(sweep::latin_hypercube_samples(37, {{"a"}}, 5)[0].numbers == latin[0].numbers);
    CHECK(sweep::latin_hypercube_samples(37, {{"a"}}, 6)[0].numbers != latin[0].numbers);
}

TEST_CASE("bad samples are refused with what was allowed", "[sweep][errors]") {
    CHECK_THROWS_WITH(sweep::parse_sample_range("x", "1:2:3"), Contains("first:last"));
    CHECK_THROWS_WITH(sweep::parse_sample_range("x", "1:2 cubic"), Contains("first:last log"));
    CHECK_THROWS_WITH(sweep::parse_sample_range("x", "0:2 log"), Contains("not positive"));
    CHECK_THROWS_WITH(sweep::sobol_samples(0, {{"a"}}), Contains("1 to 1000000"));
    CHECK_THROWS_WITH(sweep::sobol_samples(5, {}), Contains("1 to 1000"));
}

TEST_CASE("a step longer than its range is refused with what would work", "[sweep][errors]") {
    // One scene came of it without a remark: first:last:count was meant.
    CHECK_THROWS_WITH(sweep::parse_axis("x", "0:0.3:7"),
                      Contains("step of 7") && Contains("0.03") && Contains("0:0.3:7 linear"));
    CHECK_THROWS_WITH(sweep::parse_axis("wavelength_nm", "400:700:1000"), Contains("step of 1000"));
    CHECK(sweep::parse_axis("x", "0:0.3:7 linear").size() == 7);
    CHECK(sweep::parse_axis("x", "2:2:7").numbers == std::vector<double>{2});
    CHECK(sweep::parse_axis("x", "0:7:7").numbers == std::vector<double>{0, 7});
}

TEST_CASE("derivatives have the unit of the value over that of the parameter", "[sweep]") {
    // Grammar of UDUNITS: exponents behind the unit, products by blanks.
    CHECK(sweep::quotient_of_units("1", "um") == "um-1");
    CHECK(sweep::quotient_of_units("sr-1", "um") == "sr-1 um-1");
    CHECK(sweep::quotient_of_units("1", "kg m-2") == "kg-1 m2");
    CHECK(sweep::quotient_of_units("1", "m-1") == "m");
    CHECK(sweep::quotient_of_units("1", "m2") == "m-2");
    CHECK(sweep::quotient_of_units("1", "1e-9") == "1e9");
    CHECK(sweep::quotient_of_units("1", "m2/kg") == "(m2/kg)-1");
    CHECK(sweep::quotient_of_units("1", "") == "1");
    CHECK(sweep::quotient_of_units("sr-1", "1") == "sr-1");
}
