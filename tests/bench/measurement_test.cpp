#include "tools/bench/measurement.h"

#include <cmath>

#include "tests/support/catch.h"

using namespace miebrdf;

namespace {

// Burns CPU time in proportion to `work`.
std::vector<double> busy(int work) {
    volatile double sum = 0;
    for (int i = 0; i < work; ++i) sum = sum + std::sqrt(double(i));
    return {1.0 + 1.0 / work};
}

}  // namespace

TEST_CASE("the error of an answer is its largest relative difference", "[bench][measure]") {
    CHECK(bench::largest_relative_error({1, 2.2}, {1, 2}) == Approx(0.1).epsilon(1e-12));
    CHECK(bench::largest_relative_error({1, 0.5}, {1, 0}) == 0.5);
    CHECK(std::isnan(bench::largest_relative_error({}, {1})));
    CHECK(std::isnan(bench::largest_relative_error({std::nan(""), 1}, {1, 1})));
    CHECK(std::isinf(bench::largest_relative_error({1}, {1, 1})));
}

TEST_CASE("more work takes more time, and errors are those of the answers", "[bench][measure]") {
    bench::BenchCase c{"suite", "case", "q", "t", {1.0}, {}, {}};
    for (const int work : {1000, 100000}) {
        c.contenders.push_back({"busy", std::to_string(work), [=] { return busy(work); }});
    }
    const auto points = bench::measure(c, {.repeats = 3, .longest_total = 1});
    REQUIRE(points.size() == 2);
    CHECK(points[0].error == Approx(1e-3).epsilon(1e-9));
    CHECK(points[1].error == Approx(1e-5).epsilon(1e-9));
    // A hundred times the work: ten times the time even on a machine that is busy with other
    // things.
    CHECK(points[1].seconds > 10 * points[0].seconds);
    CHECK(points[0].spread >= 0);
}

TEST_CASE("a method of chance says how sure it is, in the measure of the error",
          "[bench][measure]") {
    bench::BenchCase c{"suite", "case", "q", "t", {2.0, 4.0}, {}, {}};
    c.contenders.push_back({"sure", "-", [] { return std::vector{2.2, 4.0}; }});
    c.contenders.push_back({"chance", "-", [] {
                                bench::Answer answer;
                                answer.add(2.2, 0.05);
                                answer.add(4.0, 0.4);
                                return answer;
                            }});
    const auto points = bench::measure(c, {.repeats = 1, .longest_total = 0.01});
    CHECK(std::isnan(points[0].half_width));
    CHECK(points[1].error == Approx(0.1));
    CHECK(points[1].half_width == Approx(1.96 * 0.1));  // 0.4 of 4
}

TEST_CASE("peak memory sees a large vector come and go", "[bench][measure]") {
    bench::BenchCase c{"suite", "case", "q", "t", {1.0}, {}, {}};
    c.contenders.push_back({"large", "64 MiB", [] {
                                const std::vector<double> large(8 << 20, 1.0);
                                return std::vector<double>{large[12345]};
                            }});
    const auto points = bench::measure(c, {.repeats = 1, .longest_total = 0.1});
    if (std::isnan(points[0].memory)) {
        WARN("skipped: this system does not tell the memory of a process");
        return;
    }
    // 64 MiB, give or take what the allocator and a sanitizer keep.
    CHECK(points[0].memory >= 60e6);
    CHECK(points[0].memory <= 200e6);
}
