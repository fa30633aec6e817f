// The spectral libraries ECOSTRESS and USGS splib.
#include <cmath>

#include "tests/measured/read_text.h"
#include "tests/support/catch.h"

using namespace miebrdf;
using support::read_text;
using support::values_of;
using support::wavelengths_of;
using Doubles = std::vector<double>;

namespace {

std::string ecostress_file(const std::string& data, const std::string& measurement,
                           const std::string& y_units = "Reflectance (percent)") {
    return "Name: a pavement\r\nType: manmade\r\nMeasurement: " + measurement +
           "\r\nX Units: Wavelength (micrometers)\r\nY Units: " + y_units +
           "\r\nNumber of X Values: 2\r\nAdditional Information: none\r\n\r\n" + data;
}

}  // namespace

TEST_CASE("an ECOSTRESS spectrum has its unit, angle and ascending wavelengths",
          "[measured][ecostress]") {
    const Measurements list =
        read_text(ecostress_file(" 0.5\t 25\r\n 0.4\t 50\r\n",
                                 "Directional (10 Degree) Hemispherical Reflectance"),
                  {}, "a.spectrum.txt");
    CHECK(list.format == "ecostress");
    CHECK(list.samples == std::vector<std::string>{"a pavement"});
    CHECK(wavelengths_of(list)[0] == Approx(400).epsilon(1e-14));
    CHECK(values_of(list) == Doubles{0.5, 0.25});
    CHECK(list.values[0].geometry == MeasuredGeometry::directional);
    CHECK(list.values[0].mu_in == Approx(0.98480775301221));
    CHECK(list.doubts.empty());
    const Measurements factor =
        read_text(ecostress_file("0.4 50\n0.5 25\n", "Bidirectional reflectance"));
    CHECK(factor.values[0].quantity == MeasuredQuantity::reflectance_factor);
    CHECK(read_text(ecostress_file("0.4 50\n", "", "Transmittance (percentage)"))
              .values[0]
              .quantity == MeasuredQuantity::transmittance);
}

TEST_CASE("damaged ECOSTRESS files are refused with their line", "[measured][ecostress][errors]") {
    CHECK_THROWS_WITH(read_text(ecostress_file("0.4 50\n0.5\n", "")),
                      Catch::Contains(":10: '0.5': expected"));
    CHECK_THROWS_WITH(read_text(ecostress_file("0.4 50\n-0.5 3\n", "")),
                      Catch::Contains(":10: '-0.5 3'"));
    CHECK_THROWS_WITH(read_text(ecostress_file("0.4 1\n", "", "Volts")),
                      Catch::Contains("neither reflectance"));
    CHECK_THROWS_WITH(read_text(ecostress_file("", "").substr(0, 100)),
                      Catch::Contains("no blank line"));
    CHECK_THROWS_WITH(read_text(ecostress_file("", "")), Catch::Contains("has no values"));
    const Measurements cut = read_text(ecostress_file("0.4 50\n", ""));
    REQUIRE(cut.doubts.size() == 1);
    CHECK_THAT(cut.doubts[0], Catch::Contains("1 values; its header says 2"));
}

TEST_CASE("a splib spectrum finds the wavelengths of its spectrometer and drops deleted channels",
          "[measured][splib]") {
    const support::TemporaryFolder folder;
    const std::string other = folder.write("splib_Wavelengths_BECK_um.txt",
                                           " splib Record=2: Wavelengths BECK\n 1.0\n 2.0\n 3.0\n");
    folder.write("splib_Wavelengths_ASD_um.txt",
                 " splib Record=1: Wavelengths ASD\n 4.0e-001\n 5.0e-001\n 6.0e-001\n");
    std::filesystem::create_directory(folder.path() / "chapter");
    const std::string spectrum = folder.write(
        "chapter/splib_Olivine_ASDFRa_AREF.txt",
        " splib Record=3: Olivine KI3005    ASDFRa AREF\n 2.0e-001\n-1.2300000e+034\n 3.0e-001\n");
    const Measurements list = read_measured(spectrum);
    CHECK(list.format == "splib");
    CHECK(values_of(list) == Doubles{0.2, 0.3});
    CHECK(wavelengths_of(list)[1] == Approx(600).epsilon(1e-14));
    CHECK_THAT(list.samples[0], Catch::StartsWith("Olivine KI3005"));
    REQUIRE(list.doubts.size() == 1);
    CHECK_THAT(list.doubts[0], Catch::Contains("no number; left out"));

    MeasuredOptions options;
    options.wavelengths = other;
    CHECK(wavelengths_of(read_measured(spectrum, options))[0] == 1000);
    CHECK_THROWS_WITH(read_measured(other), Catch::Contains("wavelengths, not a spectrum"));
    CHECK_THROWS_WITH(read_text(" splib Record=3: Olivine\n 2.0e-001\n"),
                      Catch::Contains("none of as many"));
    folder.write("short.txt", " splib Record=1: Wavelengths\n 1\n");
    options.wavelengths = folder / "short.txt";
    CHECK_THROWS_WITH(read_measured(spectrum, options), Catch::Contains("has 1 wavelengths"));
}
