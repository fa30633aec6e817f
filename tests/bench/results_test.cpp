// Results of runs: files, comparisons, plots and the page.
#include <cmath>
#include <sstream>

#include <miebrdf/error.h>
#include "tests/support/catch.h"
#include "tests/support/temporary_folder.h"
#include "tools/bench/report.h"
#include "tools/bench/results.h"

using namespace miebrdf;

namespace {

bench::Measurement point(const char* method, double error, double seconds, double spread = 0.02) {
    return {"suite", "case, with comma", method, "n=1", error, seconds, 4096, spread};
}

}  // namespace

TEST_CASE("the Pareto front is what no point beats in both", "[bench][results]") {
    const std::vector<bench::Measurement> points = {
        point("a", 1e-2, 1), point("b", 1e-1, 0.5),         point("c", 1e-1, 2),
        point("d", 1e-5, 3), point("e", std::nan(""), 0.1), point("f", 1e-2, 4)};
    CHECK(bench::pareto_front(points) == std::vector<std::size_t>{1, 0, 3});
    CHECK(bench::best_for(points, 1e-1)->method == "b");
    CHECK(bench::best_for(points, 1e-3)->method == "d");
    CHECK(bench::best_for(points, 1e-9) == nullptr);
}

TEST_CASE("results come back from their file", "[bench][results]") {
    bench::Results results;
    results.facts = {{"version", "x"}, {"case suite/case, with comma", "what: where"}};
    results.measurements = {point("a", 1e-2, 0.123456789012345678), point("b", std::nan(""), 2)};
    results.measurements[0].half_width = 0.25;
    const support::TemporaryFolder folder;
    std::ostringstream text;
    bench::write_results(results, text);
    const auto path = folder.write("results.csv", text.str());
    const auto back = bench::read_results(path);
    CHECK(back.facts == results.facts);
    REQUIRE(back.measurements.size() == 2);
    CHECK(back.measurements[0].test_case == "case, with comma");
    CHECK(back.measurements[0].seconds == results.measurements[0].seconds);
    CHECK(std::isnan(back.measurements[1].error));
    CHECK(back.measurements[0].half_width == 0.25);
    CHECK(std::isnan(back.measurements[1].half_width));
    const auto earlier = bench::read_results(
        folder.write("earlier.csv",
                     "suite,case,method,parameter,error,seconds,memory,spread\ns,c,m,-,1,2,3,4\n"));
    REQUIRE(earlier.measurements.size() == 1);
    CHECK(earlier.measurements[0].spread == 4);
    CHECK(std::isnan(earlier.measurements[0].half_width));
    CHECK_THROWS_AS(bench::read_results(folder.write("other.csv", "a,b\n1,2\n")), InputError);
    CHECK_THROWS_AS(bench::read_results(folder / "missing.csv"), InputError);
}

TEST_CASE("a comparison tells faster, slower, better and worse from noise", "[bench][results]") {
    bench::Results before, after;
    before.measurements = {point("quick", 1e-2, 2),      point("slow", 1e-2, 1),
                           point("noisy", 1e-2, 1, 0.5), point("good", 1e-2, 1),
                           point("bad", 1e-2, 1),        point("rounding", 1e-16, 1),
                           point("gone", 1e-2, 1)};
    after.measurements = {point("quick", 1e-2, 1),   point("slow", 1e-2, 1.5),
                          point("noisy", 1e-2, 1.4), point("good", 1e-3, 1),
                          point("bad", 1e-1, 2),     point("rounding", 1e-14, 1)};
    const auto changes = bench::compare(before, after);
    REQUIRE(changes.size() == 6);
    CHECK(changes[0].verdict == "faster");
    CHECK(changes[1].verdict == "slower");
    CHECK(changes[2].verdict == "same");
    CHECK(changes[3].verdict == "better");
    CHECK(changes[4].verdict == "slower; worse");
    CHECK(changes[5].verdict == "same");
}

TEST_CASE("rules get a table of what they save, and no curves", "[bench][results]") {
    bench::Results results;
    results.facts = {{"case rules/albedo", "Plane albedo. Truth: none from outside."}};
    results.measurements = {{"rules", "albedo", "full", "-", 0, 2, 0, 0},
                            {"rules", "albedo", "reduced", "-", 1e-9, 0.125, 0, 0},
                            point("a", 1e-2, 1)};
    const auto table = bench::rule_table(results);
    REQUIRE(table.size() == 2);
    CHECK(table[1] ==
          std::vector<std::string>{"albedo", "Plane albedo.", "2 s", "125 ms", "16", "1.0e-09"});
    const std::string page = bench::report_page(results);
    CHECK_THAT(page, Catch::Contains("<td>2 s</td><td>125 ms</td><td>16</td><td>1.0e-09</td>"));
    CHECK_THAT(page, !Catch::Contains("rules: albedo"));

    const support::TemporaryFolder folder;
    const std::string empty = "<!-- generated bench -->\n<!-- end bench -->\n";
    folder.write("accuracy.md", empty);
    folder.write("performance.md", empty);
    bench::update_bench_documents(folder / "", results);
    CHECK_THAT(support::read_file(folder / "performance.md"),
               Catch::Contains("| albedo | Plane albedo. | 2 s | 125 ms | 16 | 1.0e-09 |"));
    CHECK_THAT(support::read_file(folder / "accuracy.md"), !Catch::Contains("albedo"));
}

TEST_CASE("generated parts of a page are replaced and nothing else", "[bench][results]") {
    const std::string page = "before\n<!-- generated x -->\nold\n<!-- end x -->\nafter\n";
    CHECK(bench::with_generated_part(page, "x", "new\n") ==
          "before\n<!-- generated x -->\nnew\n<!-- end x -->\nafter\n");
    CHECK_THROWS_WITH(bench::with_generated_part(page, "y", ""), Catch::Contains("generated y"));
}

namespace {

bench::Results some_results() {
    bench::Results results;
    results.facts = {{"version", "miebrdf <test>"}, {"case suite/first", "what & why"}};
    for (int i = 1; i <= 4; ++i) {
        results.measurements.push_back({"suite", "first", "exact", "n=" + std::to_string(i),
                                        std::pow(10.0, -2 * i), 1e-3 * i, 0, 0});
        results.measurements.push_back({"suite", "first", "rough & <ready>",
                                        "n=" + std::to_string(i), 0.1 / i, 1e-4 * i, 0, 0});
    }
    results.measurements.push_back({"suite", "first", "silent", "-", std::nan(""), 1e-5, 0, 0});
    return results;
}

std::size_t count(const std::string& text, const std::string& what) {
    std::size_t n = 0;
    for (auto at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++n;
    return n;
}

}  // namespace

TEST_CASE("a plot has a curve for each method, the front, and bars for methods of chance",
          "[bench][page]") {
    auto results = some_results();
    const auto svg = bench::case_plot(results, "suite", "first");
    CHECK(count(svg, "<circle") == 8 + 2);  // points, and those of the legend
    for (const char* word : {"suite: first", "exact", "rough &amp; &lt;ready&gt;", "Pareto front",
                             "CPU time", "largest relative error"})
        CHECK(count(svg, word) >= 1);
    CHECK(count(svg, "silent") == 0);  // it has no answer
    const std::size_t lines = count(svg, "<polyline");
    results.measurements[1].half_width = 0.3 * results.measurements[1].error;
    results.measurements[3].half_width = 3 * results.measurements[3].error;
    CHECK(count(bench::case_plot(results, "suite", "first"), "<polyline") == lines + 2);
    results.measurements = {point("a", std::nan(""), 1)};
    CHECK(bench::case_plot(results, "suite", "case, with comma").empty());
    CHECK(bench::plot_file_name("suite", "case, with comma") == "suite-case-with-comma.svg");
}

TEST_CASE("the page has every point, escaped, and refers to nothing but its plots",
          "[bench][page]") {
    const auto page = bench::report_page(some_results());
    CHECK(count(page, "<tr><td>exact</td><td>n=") == 4);
    CHECK(count(page, "<td>silent</td><td>-</td><td>nan</td>") == 1);
    CHECK(count(page, "rough &amp; &lt;ready&gt;") >= 4);
    CHECK(count(page, "miebrdf &lt;test&gt;") == 1);
    CHECK(count(page, "http") == 0);
    CHECK(count(page, "src=") == 1);
    CHECK(count(page, "src=\"suite-first.svg\"") == 1);
}
