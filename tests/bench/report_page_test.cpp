// The page in a browser, if there is one: curves are drawn, nothing is fetched, no script fails.
#include "tools/bench/report_page.h"

#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "tests/support/catch.h"
#include "tests/support/temporary_folder.h"
#include "tools/bench/curve_plot.h"
#include "tools/bench/log_axis.h"

using namespace miebrdf;

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

std::string output_of(const std::string& command) {
    std::string text;
    FILE* pipe = popen(command.c_str(), "r");
    REQUIRE(pipe != nullptr);
    char buffer[4096];
    while (const std::size_t n = fread(buffer, 1, sizeof buffer, pipe)) text.append(buffer, n);
    pclose(pipe);
    return text;
}

}  // namespace

TEST_CASE("a plot labels every point with its knob and lists methods without an answer",
          "[bench][page]") {
    const auto results = some_results();
    const auto svg =
        bench::curve_plot_svg("t", results.measurements, bench::MethodStyles(results.measurements));
    CHECK(count(svg, "class='knob'") == 8);
    CHECK(count(svg, "class='curve'") == 3);  // one of them empty
    CHECK(count(svg, "<circle class='front'") == bench::pareto_front(results.measurements).size());
    CHECK_THAT(svg, Catch::Contains("no answer: silent -"));
    CHECK_THAT(svg, Catch::Contains("rough &amp; &lt;ready&gt;"));
}

TEST_CASE("whiskers stand on points of chance alone, open where they hold 0", "[bench][page]") {
    auto points = some_results().measurements;
    CHECK(count(bench::curve_plot_svg("t", points, bench::MethodStyles(points)),
                "class='whisker'") == 0);
    points[1].half_width = 0.3 * points[1].error;
    points[3].half_width = 3 * points[3].error;
    const auto svg = bench::curve_plot_svg("t", points, bench::MethodStyles(points));
    CHECK(count(svg, "class='whisker'") == 2);
    CHECK(count(svg, "m-3 0h6' stroke") == 1);  // the lower end of the first
    CHECK(count(svg, "(95 %)") == 2);
}

TEST_CASE("axes are labelled in decades", "[bench][page]") {
    const bench::LogAxis axis(1e-5, 1e-2, 0, 100);
    CHECK(axis.decades() == std::vector<int>{-5, -4, -3, -2});
    CHECK(axis.position(1e-5) < axis.position(1e-4));
    CHECK(bench::LogAxis::time_label(1e-6) == "1 us");
    CHECK(bench::LogAxis::time_label(2e-2) == "20 ms");
    CHECK(bench::LogAxis::time_label(1e2) == "100 s");
    // Few decades: more marks between them.
    CHECK(bench::LogAxis(1.5, 6, 0, 100).ticks() == std::vector<double>{2, 5});
    CHECK(bench::LogAxis(1e-5, 1e-2, 0, 100).ticks().size() == 4);
}

TEST_CASE("the page refers to nothing outside itself", "[bench][page]") {
    const auto page = bench::report_page(some_results());
    CHECK(count(page, "http://") == count(page, "http://www.w3.org/2000/svg"));
    CHECK(count(page, "https://") == 0);
    CHECK(count(page, "<link") == count(page, "href=\"data:,\""));
}

TEST_CASE("a browser draws the curves and no script fails", "[bench][page]") {
    if (std::system("command -v chromium >/dev/null 2>&1") != 0) {
        WARN("skipped: no chromium here");
        return;
    }
    const support::TemporaryFolder folder;
    // The page's own script first; then one that says what it sees and whether clicking works.
    std::string page = bench::report_page(some_results());
    page.insert(page.find("<style>"),
                "<script>window.failed=0;window.onerror=()=>{window.failed++}</script>");
    page.insert(
        page.find("</body>"),
        "<script>const e=document.querySelector('.legend');e.dispatchEvent(new Event('click'));"
        "document.body.setAttribute('data-seen',[...document.querySelectorAll('.curve')].filter("
        "c=>c.getTotalLength()>50).length+' curves, '+document.querySelectorAll('.point').length+' "
        "points, '"
        "+[...document.querySelectorAll('.series')].filter(s=>s.style.display==='none').length+' "
        "hidden, '"
        "+window.failed+' failed')</script>");
    const auto path = folder.write("page.html", page);
    const std::string dom = output_of(
        "timeout 60 chromium --headless --no-sandbox --disable-gpu --disable-quic --no-first-run "
        "--disable-background-networking --disable-component-update --disable-sync "
        "--enable-logging=stderr "
        "--user-data-dir=" +
        (folder / "profile") + " --dump-dom file://" + path + " 2>" + (folder / "log"));
    CAPTURE(dom.substr(0, 200));
    CHECK_THAT(dom, Catch::Contains("2 curves, 8 points, 1 hidden, 0 failed"));
    CHECK(count(support::read_file(folder / "log"), "CONSOLE") == 0);
}
