// `verify` finds what is wrong with figures and databases.
#include <miebrdf/database.h>

#include <algorithm>
#include <complex>
#include <vector>

#include "materials/database/sqlite.h"
#include "tests/support/catch.h"
#include "tests/support/temporary_folder.h"

using namespace miebrdf;
using namespace miebrdf::materials;

TEST_CASE("verify finds wrong values and k that does not belong to n", "[materials][verify]") {
    Dataset d;
    d.material = "M";
    d.label = "l";
    std::vector<double> x, n, k;
    for (int i = 0; i < 60; ++i) {
        // A Lorentz oscillator at 400 nm; epsilon = 1 + s / (E0^2 - E^2 - i g E).
        x.push_back(200 + 20 * i);
        const double E = 1239.841984 / x.back();
        const std::complex<double> epsilon =
            1.0 + 8.0 / std::complex<double>(9.6 - E * E, -0.5 * E);
        n.push_back(std::sqrt(epsilon).real());
        k.push_back(std::sqrt(epsilon).imag());
    }
    d.n = make_table(Unit::nanometre, x, n);
    d.k = make_table(Unit::nanometre, x, k);
    CHECK(verify(d).empty());
    // Causal by construction: only the trapezoids of k and the missing tails remain.
    CHECK(kramers_kronig_residual(d) <= 0.05);

    Dataset typing_error = d;
    typing_error.n->y[30] *= 1.3;
    REQUIRE(verify(typing_error).size() == 1);
    CHECK_THAT(verify(typing_error)[0].text,
               Catch::Contains("n jumps") && Catch::Contains("800 nm"));

    Dataset stranger = d;  // k of something else: the absorption is where n says there is none
    std::reverse(stranger.k->y.begin(), stranger.k->y.end());
    CHECK(kramers_kronig_residual(stranger) >= 0.5);

    Dataset unphysical = d;
    unphysical.k->y[3] = -1;
    unphysical.n->y[3] = 1e308;
    CHECK(verify(unphysical).at(0).severity == Finding::Severity::error);
}

TEST_CASE("verify notices a search index that was emptied", "[materials][verify]") {
    const support::TemporaryFolder folder;
    const auto file = folder.path() / "user.sqlite";
    const std::vector<std::filesystem::path> files{
        std::filesystem::path(MIEBRDF_MATERIALS_TEST_SAMPLES) / "table.csv"};
    import_files(file, files, {.material = "M"});
    CHECK(Database::open(file).integrity_problems().empty());
    sqlite::Connection::open_read_write(file).execute("DELETE FROM material_text");
    const auto problems = Database::open(file).integrity_problems();
    REQUIRE(problems.size() == 1);
    CHECK_THAT(problems[0], Catch::Contains("search index does not find 1 of 1"));
}

TEST_CASE("the embedded database verifies", "[materials][verify]") {
    for (const Finding& finding : verify(Database::embedded())) {
        CAPTURE(finding.dataset, finding.text);
        CHECK(finding.severity != Finding::Severity::error);
    }
}
