#include "pipeline/formats/spectrum_writer.h"

#include <cmath>
#include <sstream>

#include <miebrdf/error.h>
#include "pipeline/formats/readers/npz_reader.h"
#include "tests/support/catch.h"
#include "tests/support/temporary_folder.h"

using namespace miebrdf;
using namespace miebrdf::exports;

TEST_CASE("spd and irregular spectra hold the numbers and their comments", "[exports][spectrum]") {
    const Spectrum spectrum{
        {400, 500.5}, {0.25, 1.0 / 3.0}, {"albedo\nof paint", "miebrdf export --format spd"}};
    std::ostringstream spd, irregular;
    write_spd(spectrum, spd);
    CHECK(spd.str() ==
          "# albedo of paint\n# miebrdf export --format spd\n400 0.25\n500.5 0.3333333333333333\n");
    write_mitsuba_irregular(spectrum, irregular);
    CHECK_THAT(irregular.str(), Catch::Contains("value=\"400, 500.5\"") &&
                                    Catch::Contains("value=\"0.25, 0.3333333333333333\""));
    // "--" inside a comment would make the XML invalid.
    CHECK_THAT(irregular.str(), Catch::Contains("<!-- miebrdf export - -format spd -->"));
    CHECK_THROWS_WITH(write_spd({{500, 400}, {1, 1}, {}}, spd),
                      Catch::Contains("400 nm follows 500 nm"));
}

TEST_CASE("single scattering as npz: moments with and without 2 l + 1, zero beyond",
          "[exports][spectrum]") {
    const support::TemporaryFolder folder;
    ScatteringTable table{
        {500, 600}, {0.9, 0.8}, {0.5, 0.4}, {2.1, std::nan("")}, {{1, 0.5, 0.25}, {1, 0.4}}, "{}"};
    write_scattering_npz(table, folder / "s.npz");
    const auto arrays = read_npz_arrays(support::read_file(folder / "s.npz"));
    CHECK(arrays.at("chi").shape == std::vector<std::size_t>{2, 3});
    CHECK(arrays.at("lm_a1").values == std::vector<double>{1, 1.5, 1.25, 1, 1.2000000000000002, 0});
    CHECK(arrays.at("ssa").values == std::vector<double>{0.9, 0.8});
}
