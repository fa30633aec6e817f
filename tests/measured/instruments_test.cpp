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
    CHECK(values_of(list) ==
          Doubles{0.01 * 40, 0.01 * 41, 0.01 * 44, 0.01 * 45, 0.01 * 47, 0.01 * 48});
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

TEST_CASE("texts of OOIBase32, Jaz and SpectraSuite in Spanish", "[measured][instruments]") {
    const std::string old =
        "OOIBase32 Version 2.0.6.5 Data File\n++++\nDate: 03-23-2011, 12:15:51\nGraph Title: \n"
        ">>>>>Begin Spectral Data<<<<<\n400.10\t50.0\n400.50\t60.0\n>>>>>End Spectral "
        "Data<<<<<\n";
    const Measurements film = read_text(old, {}, "film.Master.Transmission");
    CHECK(values_of(film) == Doubles{0.5, 0.6});
    CHECK(film.values[0].quantity == MeasuredQuantity::transmittance);
    CHECK_THROWS_WITH(read_text(old, {}, "film.Master.Scope"), Catch::Contains("detector"));

    MeasuredOptions options;
    options.quantity = "reflectance";
    const std::string jaz =
        "Jaz Data File\n++++\nUser: jaz\nNumber of Pixels in Processed Spectrum: 2\n"
        ">>>>>Begin Processed Spectral Data<<<<<\n";
    CHECK(values_of(read_text(jaz + "W\tD\tR\tS\tP\n400.1\t10\t90\t50\t50\n401\t10\t90\t58\t60\n"
                                    ">>>>>End Processed Spectral Data<<<<<\n",
                              options)) == Doubles{0.5, 0.6});
    CHECK_THROWS_WITH(read_text(jaz + "W\tD\tS\n400.1\t10\t50\n", options),
                      Catch::Contains("no column P"));
    const Measurements spanish = read_text(
        "Fichero De Datos De SpectraSuite\r\n++++\r\nTiempo de integraci\xf3n: 3\r\n"
        ">>>>> Comienza Data<<<<< Espectral Procesado Del El\r\n190,74\t50,5\r\n191,12\t60,5\r\n"
        ">>>>> Data<<<<< Espectral Procesado Extremo\r\n",
        options);
    CHECK(wavelengths_of(spanish) == Doubles{190.74, 191.12});
    CHECK(values_of(spanish) == Doubles{0.505, 0.605});
}

TEST_CASE("three blocks of counts of SpectraSuite make one share", "[measured][instruments]") {
    const auto block = [](const std::string& title, const std::string& first,
                          const std::string& pairs) {
        return "##TITLE= SPECTRASUITE EXPORTED SPECTRA: " + title +
               " SPECTRUM\n##JCAMP-DX= 5 $$EXPORTED SPECTRASUITE FILE\n##XUNITS= NANOMETERS\n"
               "##YUNITS= Transmission (%)\n##XFACTOR= 1.0\n##YFACTOR= 1.0\n##FIRSTX= " +
               first + "\n##NPOINTS= 3\n##XYPOINTS= (XY..XY)\n" + pairs + "##END=\n";
    };
    const std::string link = "##TITLE= SPECTRASUITE EXPORTED SPECTRUM\n##DATA TYPE= LINK\n",
                      end = "##END=   $$end of all blocks\n";
    const std::string text = GENERATE_COPY(
        link + block("PROCESSED", "400.5", "400.5, 1500.5,\n401.0, 2500.5,\n401.5, 2500.5\n") +
            block("DARK", "400.5", "400.5, 1000.5,\n401.0, 500.5,\n401.5, 900.5\n") +
            block("REFERENCE", "400.5", "400.5, 2000.5,\n401.0, 5500.5,\n401.5, 900.5\n") + end,
        link + block("PROCESSED", "400,5", "400,5, 1500,5,\n401,0, 2500,5,\n401,5, 2500,5\n") +
            block("DARK", "400,5", "400,5, 1000,5,\n401,0, 500,5,\n401,5, 900,5\n") +
            block("REFERENCE", "400,5", "400,5, 2000,5,\n401,0, 5500,5,\n401,5, 900,5\n") + end);
    const Measurements list = read_text(text);
    CHECK(list.samples.size() == 1);
    CHECK(wavelengths_of(list) == Doubles{400.5, 401});  // nothing where the reference is dark
    REQUIRE(list.values.size() == 2);
    CHECK(list.values[0].value == Approx(0.5).epsilon(1e-14));
    CHECK(list.values[1].value == Approx(0.4).epsilon(1e-14));
}

TEST_CASE("Avantes' lines filled up with NUL are texts, its binary files are refused by name",
          "[measured][instruments]") {
    const std::string nul(5, '\0');
    const std::string text =
        "0804016U1- \r\nIntegration time: 100.00 ms\r\nData measured with "
        "spectrometer name: 0804016U1" +
        nul +
        "\r\nWave   ;Transmittance\r\n[nm]   ;[% transmittance]\r\n"
        "400.00;50\r\n401.00;60\r\n";
    const Measurements list = read_text(text);
    CHECK(values_of(list) == Doubles{0.5, 0.6});
    CHECK(list.values[0].quantity == MeasuredQuantity::transmittance);
    CHECK_THROWS_WITH(read_text("\x8c" + nul + "\x01", {}, "leaf.TRM"), Catch::Contains("AvaSoft"));
    CHECK_THROWS_WITH(read_text("PK\x03\x04" + nul + "\x01", {}, "leaf.ProcSpec"),
                      Catch::Contains("SpectraSuite"));
}

TEST_CASE("OPUS' tables without names have wavenumbers", "[measured][instruments]") {
    const Measurements list = read_text("10000,0.2\r\n8000,0.3\r\n5000,0.4\r\n", {}, "a.dpt");
    CHECK(wavelengths_of(list) == Doubles{1000, 1250, 2000});
    CHECK(values_of(list) == Doubles{0.2, 0.3, 0.4});
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
    // The scale may stand in the title alone.
    std::string titled = header;
    titled.replace(titled.find("reflectance scale factor = 10000\n"), 33, "");
    titled.replace(titled.find("Reflectance}"), 11, "reflectance [*10000]");
    CHECK(values_of(read_measured(folder.write("lib.hdr", titled))) ==
          Doubles{0.1, 0.2, 0.3, 0.4, 0.6});
    folder.write("lib.hdr", header);
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
    CHECK_THROWS_WITH(read_text("{\"extensions\":{\"OpenMaterial_ior_data\":{}}}"),
                      Catch::Contains("no measurements"));
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
