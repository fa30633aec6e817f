// Lists, ranges and columns of files.
#include <miebrdf/error.h>

#include <cmath>

#include "pipeline/sweep/axis_values.h"
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
                      Contains("line 2"));
    CHECK_THROWS_AS(sweep::read_columns(folder / "none.csv", {}), InputError);
}
