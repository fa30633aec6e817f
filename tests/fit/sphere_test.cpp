// Fits of what integrating spheres read: iad's own examples.
#include <miebrdf/error.h>
#include <miebrdf/fit.h>

#include <fmt/format.h>

#include <cmath>
#include <string>

#include "tests/support/catch.h"
#include "tests/support/temporary_folder.h"

using namespace miebrdf;

namespace {

/// An example of Scott Prahl's iad (its repository, tests/rxt), a line of it, and what iad 4.0.0
/// prints for it with 32 directions and no traced light (-M 0 -q 32 -e 1e-7), in 1/mm.
struct Example {
    std::string name, index, slide, thickness;
    std::string header;  ///< what follows the slides' thickness
    std::string line;
    double mu_a, mu_s;
};

const Example kTio2 = {"tio2_vis.rxt",
                       "1.34",
                       "1.45",
                       "11.3",
                       "10 0.96 1 203.2 50.8 19.1 1 0.98 203.2 50.8 19.1 1 0.98 L r t R T",
                       "600 0.72197 0.18846 0.99 0.99",
                       0.0015,
                       1.3154};

const std::string kSmallSphere = "203.2 25.4 12.7 1 0.96 ";

const Example kExamples[] = {
    kTio2,
    {"sample_C.rxt", "1.34", "1.50", "1", "5 0.96 1 " + kSmallSphere + kSmallSphere + "2",
     "800 0.16830 0.24974", 0.4041, 1.4352},
    {"sample_D.rxt", "1.34", "1.50", "1", "5 0.96 1 " + kSmallSphere + kSmallSphere + "5",
     "925 0.47248 0.47882 0 0.97 0.991", 0.0258, 2.6309},
    {"sample_E.rxt", "1.34", "1.50", "1", "5 0.96 2 " + kSmallSphere + kSmallSphere + "2",
     "800 0.16830 0.24974", 0.4385, 1.3754},
    {"double.rxt", "1.468", "", "6.67",
     "4 0.99 2 203.2 31.75 6.35 3.18 0.975 203.2 31.75 0 3.18 0.975 2", "600 0.43778 0.18079",
     0.0195, 0.8428}};

/// mu_a and mu_s' of its first line.
FitResult fit_of(const Example& e, const std::string& words) {
    const support::TemporaryFolder folder;
    folder.write("example.rxt",
                 fmt::format("IAD1 {} {} {} 1 {}\n{}\n", e.index, e.slide.empty() ? "1" : e.slide,
                             e.thickness, e.header, e.line));
    const std::string slide = e.slide.empty() ? "" : fmt::format("\"slide:{}@1mm\",", e.slide);
    std::string text = fmt::format(
        "[scene]\nsubstrate = \"none\"\nboundary = \"smooth\"\ntolerance = 1e-6\nstokes = 1\n"
        "coat = [{0} \"turbid:{{mua}},{{mus}},0 in index:{1}@{2}mm\", {0}]\n[unknowns]\n"
        "mua = \"0.02 in 1e-5:10 log\"\nmus = \"1 in 0.01:100 log\"\n",
        slide, e.index, e.thickness);
    for (const char* quantity : {"reflectance", "transmittance"})
        text += fmt::format(
            "[[measured]]\nfile = \"example.rxt\"\ncolumn = \"{}\"\nmu_in = 1\n"
            "sigma = 1e-4\n{}\n",
            quantity, words);
    FitProblem problem = read_fit_text(text, folder.path().string(), "example.toml");
    problem.starts = 1;
    return fit(problem);
}

}  // namespace

TEST_CASE("iad's examples with one sphere and with two are found as it prints them",
          "[fit][sphere]") {
    if (!has_fit()) return;
    for (const Example& e : kExamples) {
        CAPTURE(e.name);
        const FitResult found = fit_of(e, "sphere = \"iad\"");
        CHECK(found.converged);
        // Its last digits: with 8 directions iad itself is off by .002, with 32 by a sixteenth.
        CHECK(std::abs(found.values[0].value - e.mu_a) <= 1.5e-4);
        CHECK(std::abs(found.values[1].value - e.mu_s) <= 4e-4 * e.mu_s);
    }
}

TEST_CASE("without its sphere a phantom seems to scatter half as much", "[fit][sphere]") {
    if (!has_fit()) return;
    // iad -S 0 -q 8 prints .7427.
    CHECK(std::abs(fit_of(kTio2, "").values[1].value - 0.7427) <= 0.003);
    // A standard that reads itself, which iad's does not: 2 % of the reflectance.
    const double own = fit_of(kTio2, "sphere = \"file\"").values[1].value;
    CHECK(own < 1.3154);
    CHECK(own > 1.0);
}

TEST_CASE("spheres are refused where they say nothing, with what to write",
          "[fit][sphere][errors]") {
    CHECK_THROWS_WITH(fit_of(kTio2, "sphere = \"own\""), Catch::Contains("\"file\" or \"iad\""));
    CHECK_THROWS_WITH(fit_of(kTio2, "sphere = { wall = 2 }"), Catch::Contains("wall"));
    CHECK_THROWS_WITH(fit_of(kTio2, "sphere = { wall = 0.9 }"), Catch::Contains("sample_port"));
    CHECK_THROWS_WITH(fit_of(kTio2, "other_sphere = { wall = 0.9 }"), Catch::Contains("beside"));
}
