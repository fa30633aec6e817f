// Interpolation in tables that are known at every point.
#include <miebrdf/error.h>

#include <cmath>
#include <functional>
#include <limits>

#include "pipeline/sweep/lookup.h"
#include "tests/support/catch.h"

using namespace miebrdf;
using sweep::Interpolation;

namespace {

/// f(x, y) at the nodes of two axes.
class FunctionTable : public sweep::StoredTable {
  public:
    std::vector<double> x = {1, 2, 4, 5, 7, 8}, y = {1, 10, 100, 1000, 10000};
    std::function<double(double, double)> f;

    std::vector<std::string> variables() const override { return {"f"}; }
    std::string unit_of(const std::string&) const override { return "1"; }
    std::vector<sweep::StoredAxis> axes_of(const std::string&) const override {
        return {{.name = "x", .numbers = x}, {.name = "y", .numbers = y, .is_logarithmic = true}};
    }
    std::vector<double> read(const std::string&, const std::vector<std::size_t>& start,
                             const std::vector<std::size_t>& count) const override {
        std::vector<double> values;
        for (std::size_t i = 0; i < count[0]; ++i) {
            for (std::size_t j = 0; j < count[1]; ++j)
                values.push_back(f(x[start[0] + i], y[start[1] + j]));
        }
        return values;
    }
};

}  // namespace

TEST_CASE("polynomials of the order of the interpolation come back, with no error",
          "[sweep][lookup]") {
    FunctionTable table;
    const bool is_cubic = GENERATE(false, true);
    const auto order = is_cubic ? Interpolation::cubic : Interpolation::linear;
    table.f = [&](double x, double y) {
        const double l = std::log(y);
        return is_cubic ? (x * x * x - 5 * x) * (1 + l - 0.1 * l * l * l) : (2 - 3 * x) * (1 + l);
    };
    for (const double x : {1.0, 1.3, 3.0, 4.5, 7.9, 8.0}) {
        for (const double y : {1.0, 3.0, 55.0, 9000.0}) {
            const auto found = sweep::look_up(
                table, "f", {{"x", std::to_string(x)}, {"y", std::to_string(y)}}, order);
            CAPTURE(x, y, is_cubic);
            REQUIRE(found.values.size() == 1);
            // Rounding of sums of up to 36 terms, each of which may be ten times the value.
            const double bound = 1e-11 * (std::abs(table.f(x, y)) + 400.0);
            CHECK(std::abs(found.values[0] - table.f(x, y)) <= bound);
            CHECK(found.errors[0] <= bound);
        }
    }
}

TEST_CASE("left-out nodes tell the error of the next degree exactly", "[sweep][lookup]") {
    // Along x alone: the divided difference of x^2 is 1 everywhere, so the estimate is the error.
    FunctionTable table;
    table.f = [](double x, double) { return x * x; };
    for (const double x : {1.5, 3.0, 4.25, 6.0, 7.5}) {
        const auto found = sweep::look_up(table, "f", {{"x", std::to_string(x)}, {"y", "10"}},
                                          Interpolation::linear);
        CAPTURE(x);
        CHECK(found.errors[0] == Approx(std::abs(found.values[0] - x * x)).epsilon(1e-12));
    }
}

TEST_CASE("the estimate bounds the error of a smooth function within a factor", "[sweep][lookup]") {
    FunctionTable table;
    table.f = [](double x, double y) { return std::exp(-0.3 * x) * (3 + std::log(y)); };
    const auto order = GENERATE(Interpolation::linear, Interpolation::cubic);
    for (const double x : {1.5, 3.0, 4.5, 6.0, 7.5}) {
        const auto found =
            sweep::look_up(table, "f", {{"x", std::to_string(x)}, {"y", "30"}}, order);
        CAPTURE(x, found.values[0], found.errors[0]);
        // The derivative that the error has varies by e^(0.3 * 4) over the nodes that are used.
        CHECK(std::abs(found.values[0] - table.f(x, 30)) <= 3.4 * found.errors[0]);
        CHECK(found.errors[0] <= 3.4 * std::abs(found.values[0] - table.f(x, 30)));
    }
}

TEST_CASE("axes that are not asked are listed, nodes that failed stay alone", "[sweep][lookup]") {
    FunctionTable table;
    const double none = std::numeric_limits<double>::quiet_NaN();
    table.f = [&](double x, double y) { return x == 7 ? none : x + std::log10(y); };
    const auto found = sweep::look_up(table, "f", {{"x", "3"}}, Interpolation::linear);
    REQUIRE(found.listed.size() == 1);
    REQUIRE(found.values.size() == table.y.size());
    for (std::size_t i = 0; i < table.y.size(); ++i)
        CHECK(found.values[i] == Approx(3 + double(i)).epsilon(1e-14));
    const auto at = [&](const char* x) {
        return sweep::look_up(table, "f", {{"x", x}, {"y", "10"}}, Interpolation::linear);
    };
    CHECK(std::isnan(at("6").values[0]));
    CHECK(at("5").values[0] == 6.0);
    CHECK(at("4.5").values[0] == Approx(5.5).epsilon(1e-14));
    CHECK(std::isnan(at("4.5").errors[0]));  // its witness failed
}

TEST_CASE("what a table does not have is refused", "[sweep][lookup][errors]") {
    FunctionTable table;
    table.f = [](double x, double) { return x; };
    CHECK_THROWS_WITH(sweep::look_up(table, "f", {{"x", "9"}}, Interpolation::linear),
                      Catch::Contains("9") && Catch::Contains("1 to 8"));
    CHECK_THROWS_AS(sweep::look_up(table, "f", {{"x", "much"}}, Interpolation::linear), UsageError);
    table.x = {1, 2};  // no node to leave out
    const auto found =
        sweep::look_up(table, "f", {{"x", "1.5"}, {"y", "1"}}, Interpolation::linear);
    CHECK(found.values[0] == 1.5);
    CHECK(std::isnan(found.errors[0]));
    CHECK_THROWS_WITH(sweep::parse_interpolation("spline"), Catch::Contains("linear, cubic"));
}
