// CGATS text.
#include "tests/measured/read_text.h"
#include "tests/support/catch.h"

using namespace miebrdf;
using support::read_text;
using Doubles = std::vector<double>;

namespace {

std::string cgats_file(const std::string& fields, const std::string& rows,
                       const std::string& keywords = "") {
    return "CGATS.17\nORIGINATOR \"somebody\"\n" + keywords +
           "BEGIN_DATA_FORMAT\nSAMPLE_ID SAMPLE_NAME " + fields +
           "\nEND_DATA_FORMAT\nNUMBER_OF_SETS 2\nBEGIN_DATA\n" + rows + "END_DATA\n";
}

}  // namespace

TEST_CASE("fields of spectra go by several names", "[measured][cgats]") {
    const std::string name =
        GENERATE("SPECTRAL_NM", "SPECTRAL_NM_", "SPECTRAL_", "nm", "R_", "NM_");
    CAPTURE(name);
    const Measurements list = read_text(
        cgats_file(name + "400 " + name + "410", "1 a 0.4 0.5\n2 b 0.01 0.02\n"), {}, "chart.txt");
    CHECK(support::values_of(list) == Doubles{0.4, 0.5, 0.01, 0.02});
}

TEST_CASE("spectra and Lab of CGATS tables are read with their scale and geometry",
          "[measured][cgats]") {
    const Measurements list =
        read_text(cgats_file("LAB_L LAB_A LAB_B SPECTRAL_NM400 SPECTRAL_NM410",
                             "1 \"light grey\" 70 1 -2 0.4 0.5\n2 black 10 0 0 0.01 0.02\n",
                             "MEASUREMENT_GEOMETRY \"45/0\"\n"),
                  {}, "chart.txt");
    CHECK(list.format == "cgats");
    CHECK(list.samples == std::vector<std::string>{"1 light grey", "2 black"});
    CHECK(support::values_of(list) == Doubles{0.4, 0.5, 70, 1, -2, 0.01, 0.02, 10, 0, 0});
    CHECK(list.values[0].geometry == MeasuredGeometry::d45_0);
    CHECK(list.values[0].quantity == MeasuredQuantity::reflectance_factor);
    CHECK(list.values[4].quantity == MeasuredQuantity::lab_b);
    CHECK(list.values[1].wavelength_nm == 410);
}

TEST_CASE("spectra relative to 100 become shares", "[measured][cgats]") {
    const std::string rows = "1 a 40 50\n2 b 1 2\n";
    const Measurements argyll = read_text(cgats_file("SPEC_400 SPEC_410", rows));
    CHECK(support::values_of(argyll) == Doubles{0.4, 0.5, 0.01, 0.02});
    const Measurements norm =
        read_text(cgats_file("nm400 nm410", rows, "SPECTRAL_NORM \"100.0\"\n"));
    CHECK(support::values_of(norm) == Doubles{0.4, 0.5, 0.01, 0.02});
    CHECK_THROWS_WITH(read_text(cgats_file("nm400 nm410", rows)), Catch::Contains("percent"));
    MeasuredOptions percent;
    percent.percent = true;
    CHECK(support::values_of(read_text(cgats_file("nm400 nm410", rows), percent)).front() == 0.4);
}

TEST_CASE("damaged CGATS tables are refused with their line", "[measured][cgats][errors]") {
    CHECK_THROWS_WITH(read_text(cgats_file("nm400", "1 a 0.5\n2 b\n")),
                      Catch::Contains(":9: 2 fields"));
    CHECK_THROWS_WITH(read_text(cgats_file("nm400", "1 a 0.5\n2 b bright\n")),
                      Catch::Contains(":9: 'bright'"));
    CHECK_THROWS_WITH(read_text(cgats_file("nm400", "1 a 0.5\n")),
                      Catch::Contains("1 rows; NUMBER_OF_SETS says 2"));
    CHECK_THROWS_WITH(read_text(cgats_file("RGB_R", "1 a 0.5\n2 b 1\n")),
                      Catch::Contains("neither spectra nor Lab"));
    const std::string whole = cgats_file("nm400", "1 a 0.5\n2 b 0.5\n");
    CHECK_THROWS_WITH(read_text(whole.substr(0, whole.size() - 12)), Catch::Contains("cut off"));
}
