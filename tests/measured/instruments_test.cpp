// Files of field and laboratory spectrometers, libraries and tables; the layouts are those of
// public descriptions and files, the numbers are ours.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "tests/measured/read_text.h"
#include "tests/support/catch.h"

using namespace miebrdf;
using support::read_text;
using support::values_of;
using support::wavelengths_of;
using Doubles = std::vector<double>;

TEST_CASE("SVC files have reflectance in percent, or panel and sample", "[measured][instruments]") {
    const std::string head =
        "/*** Spectra Vista SIG Data ***/\nname= leaf\nunits= Radiance, Radiance\n"
        "comm= \nmemory slot= 0, 0\ndata= \n";
    const Measurements list = read_text(
        head + "400.0  200.0  50.0  25.00\n401.5  200.0  60.0  30.00\n403.0  0.0  60.0  -9999\n");
    CHECK(list.format == "svc");
    CHECK(list.samples == std::vector<std::string>{"leaf"});
    CHECK(values_of(list) == Doubles{0.25, 0.3});
    CHECK(list.values[0].quantity == MeasuredQuantity::reflectance_factor);
    CHECK(values_of(read_text(head + "400 200 50\n401 0 60\n402 200 60\n")) == Doubles{0.25, 0.3});
    const auto told = [](const Measurements& of, const std::string& fact) {
        return std::any_of(of.facts.begin(), of.facts.end(),
                           [&](const auto& one) { return one.first == fact; });
    };
    CHECK(told(list, "unit"));
    CHECK_FALSE(told(read_text(head + "400 200 50\n402 200 60\n"), "unit"));  // no percent
    CHECK_THROWS_WITH(read_text(head + "400 200\n"), Catch::Contains("2 numbers"));
    CHECK_THROWS_WITH(read_text(head), Catch::Contains("data="));
}

TEST_CASE("where detectors of SVC overlap, each counts on its side of the middle",
          "[measured][instruments]") {
    const std::string text =
        "/*** Spectra Vista SIG Data ***/\nfactors= 0.8, 0.8, 1.0 [Overlap: Preserve]\ndata= \n"
        "980 100 40 40\n990 100 41 41\n1000 100 42 42\n1010 100 60 60\n"
        "982 100 30 30\n990 100 43 43\n998 100 44 44\n1006 100 45 45\n1890 100 46 46\n"
        "1885 100 20 20\n1889 100 47 47\n1895 100 48 48\n";
    // The middles are 996 and 1887.5 nm: 990 nm counts once, of the first detector.
    const Measurements list = read_text(text);
    CHECK(wavelengths_of(list) == Doubles{980, 990, 998, 1006, 1889, 1895});
    CHECK(values_of(list) == Doubles{0.4, 0.41, 0.44, 0.45, 0.47, 0.48});
    REQUIRE_FALSE(list.doubts.empty());
    CHECK_THAT(list.doubts[0], Catch::Contains("982 to 1010 nm (cut at 996, from 0.41 to 0.44)"));
    CHECK_THAT(list.doubts[0], Catch::Contains("1885 to 1890 nm (cut at 1887.5"));
}

TEST_CASE("Spectral Evolution and Avantes texts are tables with lines above them",
          "[measured][instruments]") {
    const auto text = GENERATE(
        "Comment:\nVersion: 2.3 [1.2]\nWavelength Range: 350,2500\nColumns [4]:\nData:\n"
        "Wvl\tRad. (Ref.)\tRad. (Target)\tTgt./Ref. %\n400.0\t2\t1\t50\n401.0\t2\t1.2\t60\n",
        "Columns [5]:\nData:\nChan.#\tWavel.\tNorm. DN (Ref.)\tNorm. DN (Target)\tReflect. %\n"
        "0\t400.0\t2\t1\t50\n1\t401.0\t2\t1.2\t60\n",
        "0601030U1\nIntegration time [ms]:  15,000\nAveraging Nr. [scans]: 10\n"
        "Data measured with spectrometer [name]: 0601030U1\n"
        "Wave   ;Sample   ;Dark     ;Reference;Reflectance\n"
        "[nm]   ;[counts] ;[counts] ;[counts] ;[%]\n\n"
        " 400,00;  812,000;  700,0;  900,0;50,0\n 401,00;  813,000;  700,0;  900,0;60,0\n");
    CAPTURE(text);
    const Measurements list = read_text(text);
    CHECK(wavelengths_of(list) == Doubles{400, 401});
    CHECK(values_of(list) == Doubles{0.5, 0.6});
    CHECK(list.samples.size() == 1);  // "Sample [counts]" names none
}

TEST_CASE("radiances of panel and sample alone are no reflectance, nor are numbers of channels",
          "[measured][instruments]") {
    CHECK_THROWS_WITH(read_text("Columns [4]:\nData:\nChan.#\tWavel.\tRad. (Ref.)\tRad. (Target)\n"
                                "0\t400.0\t2\t1\n1\t401.0\t2\t1.2\n"),
                      Catch::Contains("numbers of channels"));
}

TEST_CASE("Ocean Optics texts say what they are in their first line, or are asked",
          "[measured][instruments]") {
    const std::string rest =
        " Node\n\nDate: Mon Mar 02\nUser: x\nXAxis mode: Wavelengths\n"
        ">>>>>Begin Spectral Data<<<<<\n400.1\t50\n400.5\t60\n";
    CHECK(values_of(read_text("Data from leaf_Reflection_0001.txt" + rest)) == Doubles{0.5, 0.6});
    const Measurements film = read_text("Data from film_Transmission_1.txt" + rest);
    CHECK(film.values[0].quantity == MeasuredQuantity::transmittance);
    CHECK_THROWS_WITH(read_text("Data from leaf_0001.txt" + rest), Catch::Contains("quantity"));
    std::string by_number = rest;
    by_number.replace(by_number.find("Wavelengths"), 11, "Raman Shift");
    CHECK_THROWS_WITH(read_text("Data from leaf_Reflection_1.txt" + by_number),
                      Catch::Contains("Raman Shift"));
    CHECK_THROWS_WITH(read_text("Data from sun_Irradiance_1.txt" + rest),
                      Catch::Contains("irradiance"));
    MeasuredOptions options;
    options.quantity = "reflectance";
    options.percent = true;
    CHECK(values_of(read_text("Data from leaf_0001.txt" + rest, options)) == Doubles{0.5, 0.6});
}

TEST_CASE("ENVI libraries are read by their header or their numbers", "[measured][instruments]") {
    const support::TemporaryFolder folder;
    const std::string header =
        "ENVI\ndescription = {\n  ours}\nsamples = 3\nlines = 2\nbands = 1\nheader offset = 0\n"
        "file type = ENVI Spectral Library\ndata type = 2\nbyte order = 1\n"
        "wavelength units = Micrometers\nreflectance scale factor = 10000\n"
        "z plot titles = {Wavelength, Reflectance}\nspectra names = {\n soil, grass}\n"
        "wavelength = {\n 0.4, 0.5,\n 0.6}\n";
    std::string bytes;
    for (const int number : {1000, 2000, 3000, 4000, -9999, 6000}) {
        bytes += static_cast<char>((number >> 8) & 0xff);
        bytes += static_cast<char>(number & 0xff);
    }
    const std::string hdr = folder.write("lib.hdr", header), sli = folder.write("lib.sli", bytes);
    for (const std::string& path : {hdr, sli}) {
        const Measurements list = read_measured(path);
        CHECK(list.format == "envi");
        CHECK(list.samples == std::vector<std::string>{"soil", "grass"});
        CHECK(values_of(list) == Doubles{0.1, 0.2, 0.3, 0.4, 0.6});
        CHECK(list.values[0].wavelength_nm == Approx(400).epsilon(1e-14));
    }
    folder.write("lib.sli", bytes.substr(0, 9));
    CHECK_THROWS_WITH(read_measured(hdr), Catch::Contains("9 bytes"));
}

TEST_CASE("OpenMATERIAL tables have metres and radians", "[measured][instruments]") {
    const std::string text =
        "{\"metadata\":{\"name\":\"asphalt\"},\"brdf\":{\"wavelengths\":[9.05e-07],\"lookupTable\":"
        "["
        "[9.05e-07,0.5235987755982988,0.5235987755982988,0,0.2],"
        "[9.05e-07,0.5235987755982988,0.5235987755982988,3.141592653589793,0.03],"
        "[9.05e-07,0.5235987755982988,0.1,0,null]]}}";
    const Measurements list = read_text(text);
    CHECK(list.format == "openmaterial");
    REQUIRE(list.values.size() == 2);
    CHECK(list.values[0].wavelength_nm == Approx(905).epsilon(1e-12));
    CHECK(list.values[0].mu_in == Approx(std::sqrt(0.75)).epsilon(1e-14));
    CHECK(list.values[0].azimuth_deg == Approx(0).margin(1e-9));
    CHECK(list.values[0].value == 0.2);
    CHECK_THROWS_WITH(read_text("{\"brdf\":{\"lookupTable\":[[1,2]]}}"), Catch::Contains("5"));
    CHECK_THROWS_WITH(read_text("{\"brdf\":{\"lookupTable\":[[905,0.5,0.5,0,0.2]]}}"),
                      Catch::Contains("905 m"));
}

TEST_CASE("custom spectra of CxF are what they say", "[measured][instruments]") {
    const auto file = [](const std::string& type) {
        return "<cc:CxF xmlns:cc=\"http://colorexchangeformat.com/CxF3-core\"><cc:Resources>"
               "<cc:ObjectCollection><cc:Object Name=\"P\" Id=\"c\"><cc:ColorValues>"
               "<cc:CustomSpectrum ColorSpecification=\"s\" StartWL=\"400\" Increment=\"10\">1 1 1"
               "</cc:CustomSpectrum></cc:ColorValues></cc:Object></cc:ObjectCollection>"
               "<cc:ColorSpecificationCollection><cc:ColorSpecification Id=\"s\">"
               "<cc:MeasurementSpec><cc:MeasurementType>" +
               type +
               "</cc:MeasurementType></cc:MeasurementSpec></cc:ColorSpecification>"
               "</cc:ColorSpecificationCollection></cc:Resources></cc:CxF>";
    };
    CHECK(read_text(file("Spectrum_Transmittance")).values[0].quantity ==
          MeasuredQuantity::transmittance);
    CHECK(read_text(file("Spectrum_Absorbance")).values[0].value == Approx(0.1));
    CHECK_THROWS_WITH(read_text(file("Spectrum_Emissive")), Catch::Contains("no reflectance"));
}
