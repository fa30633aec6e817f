#include <cmath>

#include <miebrdf/formats.h>
#include "pipeline/formats/table/npz.h"
#include "tests/support/catch.h"
#include "tests/support/temporary_folder.h"

using namespace miebrdf;

TEST_CASE("spd and irregular spectra hold the numbers and their comments", "[formats][spectrum]") {
    const ReflectanceSpectrum spectrum{
        {400, 500.5}, {0.25, 1.0 / 3.0}, {"albedo\nof paint", "miebrdf export --format spd"}};
    const support::TemporaryFolder folder;
    export_spectrum(spectrum, "spd", folder / "a.spd");
    CHECK(support::read_file(folder / "a.spd") ==
          "# albedo of paint\n# miebrdf export --format spd\n400 0.25\n500.5 0.3333333333333333\n");
    export_spectrum(spectrum, "irregular", folder / "a.xml");
    const std::string irregular = support::read_file(folder / "a.xml");
    CHECK_THAT(irregular, Catch::Contains("value=\"400, 500.5\"") &&
                              Catch::Contains("value=\"0.25, 0.3333333333333333\""));
    // "--" inside a comment would make the XML invalid.
    CHECK_THAT(irregular, Catch::Contains("<!-- miebrdf export - -format spd -->"));
    CHECK_THROWS_WITH(export_spectrum({{500, 400}, {1, 1}, {}}, "spd", folder / "b.spd"),
                      Catch::Contains("400 nm follows 500 nm"));
    CHECK_THROWS_AS(export_spectrum({}, "spd", folder / "b.spd"), UsageError);
    CHECK(folder.count() == 2);
}

TEST_CASE("single scattering as npz: moments with and without 2 l + 1, zero beyond",
          "[formats][spectrum]") {
    const support::TemporaryFolder folder;
    ScatteringTable table{
        {500, 600}, {0.9, 0.8}, {0.5, 0.4}, {2.1, std::nan("")}, {{1, 0.5, 0.25}, {1, 0.4}}, "{}"};
    export_scattering(table, "scattering", folder / "s.npz");
    const auto arrays = read_npz_arrays(support::read_file(folder / "s.npz"));
    CHECK(arrays.at("chi").shape == std::vector<std::size_t>{2, 3});
    CHECK(arrays.at("lm_a1").values == std::vector<double>{1, 1.5, 1.25, 1, 1.2000000000000002, 0});
    CHECK(arrays.at("ssa").values == std::vector<double>{0.9, 0.8});
}
