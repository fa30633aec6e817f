// What names of values mean, what is no value, and what several kinds in one file become.
#include <cmath>
#include <string>
#include <vector>

#include "tests/measured/read_text.h"
#include "tests/support/catch.h"

using namespace miebrdf;
using support::fact_of;
using support::read_text;
using support::values_of;
using support::wavelengths_of;
using Doubles = std::vector<double>;

TEST_CASE("columns of transmittance, absorbance and logarithms are what their names say",
          "[measured][meaning]") {
    struct Case {
        const char *name, *value;
        double share;
        MeasuredQuantity quantity;
    };
    using enum MeasuredQuantity;
    const auto [name, value, share, quantity] = GENERATE(
        Case{"%T", "10", 0.1, transmittance}, Case{"T", "0.1", 0.1, transmittance},
        Case{"Transmission (%)", "10", 0.1, transmittance},
        Case{"Absorbance", "1", 0.1, transmittance}, Case{"A", "1", 0.1, transmittance},
        Case{"Abs. (AU)", "1", 0.1, transmittance}, Case{"OD", "1", 0.1, transmittance},
        Case{"Optical Density", "1", 0.1, transmittance}, Case{"log(1/R)", "1", 0.1, reflectance},
        Case{"log 1/R", "1", 0.1, reflectance}, Case{"-log10(R)", "1", 0.1, reflectance},
        Case{"Apparent absorbance", "1", 0.1, reflectance}, Case{"F(R)", "0.25", 0.5, reflectance},
        Case{"Kubelka-Munk", "0.25", 0.5, reflectance}, Case{"Reflect. %", "10", 0.1, reflectance},
        Case{"Reflection (%)", "10", 0.1, reflectance},
        Case{"Diffuse Reflectance [1]", "0.1", 0.1, reflectance});
    CAPTURE(name);
    const Measurements list = read_text(std::string("wavelength_nm;") + name + "\n400;" + value +
                                        "\n500;" + value + "\n");
    CHECK(list.values[0].value == Approx(share).epsilon(1e-14));
    CHECK(list.values[0].quantity == quantity);
}

TEST_CASE("names of what is no share of the light are refused, or said to be unread beside one",
          "[measured][meaning][errors]") {
    const std::string name =
        GENERATE("absorptance", "K/S", "k", "extinction", "emissivity", "Radiance (W/m2/sr/nm)",
                 "Irradiance", "DN", "Counts", "Light source", "Lamp", "Rad. (Ref.)", "T (K)",
                 "Norm. DN (Target)", "n", "Single scattering albedo", "mu_s' (1/mm)",
                 "Signal (mV)", "E (W/m2)", "Quantum efficiency (%)", "g");
    CAPTURE(name);
    const std::string head = "wavelength_nm;" + name;
    CHECK_THROWS_WITH(read_text(head + "\n400;0.1\n500;0.2\n"), Catch::Contains(name));
    const Measurements beside = read_text(head + ";reflectance\n400;0.1;0.5\n500;0.2;0.6\n");
    CHECK(values_of(beside) == Doubles{0.5, 0.6});
    CHECK_THAT(fact_of(beside, "columns not read"), Catch::Contains(name));
    MeasuredOptions said;
    said.quantity = "reflectance";
    CHECK(read_text(head + "\n400;0.1\n500;0.2\n", said).values.size() == 2);
}

TEST_CASE("samples may be called as sources and places are", "[measured][meaning]") {
    const std::string name = GENERATE("Lamp black", "film (2 mm)", "leaf (C)", "signal red");
    const Measurements list = read_text("wavelength_nm;" + name + "\n400;0.1\n500;0.2\n");
    CHECK(values_of(list) == Doubles{0.1, 0.2});
    CHECK(list.values[0].quantity == MeasuredQuantity::reflectance);
}

TEST_CASE("noise beyond any share is left out and counted, percent is refused",
          "[measured][meaning]") {
    std::string text = "wavelength_nm,reflectance\n";
    for (int nm = 400; nm < 600; ++nm) text += std::to_string(nm) + ",0.4\n";
    const Measurements list = read_text(text + "600,11.98\n601,-14.03\n602,0.4\n");
    CHECK(list.values.size() == 201);
    CHECK_THAT(list.doubts.at(0), Catch::Contains("11.98") && Catch::Contains("2 values in all"));
    // A dark sample in percent has small values, too, but its large ones are smooth.
    CHECK_THROWS_WITH(
        read_text("nm,R\n400,0.4\n410,0.5\n420,0.7\n430,1.9\n440,2.2\n450,2.4\n460,0.9\n470,0.6\n"),
        Catch::Contains("percent"));
}

TEST_CASE("what stands for no value is left out and said once", "[measured][meaning]") {
    const std::string word = GENERATE("-9999", "-999", "-9999.0", "-999.99", "-1.23e34", "1e20",
                                      "nan", "", "n/a", "#N/A", "?", "--", "9.96921e36", "-99.9");
    CAPTURE(word);
    const Measurements list =
        read_text("wavelength_nm,reflectance\n350,0.18\n351," + word + "\n352,0.2\n");
    CHECK(values_of(list) == Doubles{0.18, 0.2});
    CHECK_THAT(list.doubts.at(0), Catch::Contains("file.csv:3: no number; left out"));
    const std::string separator = GENERATE("\t", ",", " ");
    const Measurements bare = read_text("350" + separator + "0.18\n351" + separator + word +
                                        "\n352" + separator + "0.2\n");
    CHECK(wavelengths_of(bare) == Doubles{350, 352});
}

TEST_CASE("signed angles keep their side beside an azimuth", "[measured][meaning]") {
    const Measurements list = read_text(
        "wavelength_nm,theta_i,theta_r,azimuth_deg,brdf\n550,30,10,0,0.21\n550,30,-10,0,0.35\n"
        "550,-30,-10,0,0.4\n550,30,-40,90,0.5\n");
    REQUIRE(list.values.size() == 4);
    CHECK(list.values[0].azimuth_deg == 0);
    CHECK(list.values[1].azimuth_deg == 180);
    CHECK(list.values[2].azimuth_deg == 0);
    CHECK(list.values[3].azimuth_deg == 270);
    const Measurements radians = read_text(
        "nm,theta_i [radians],theta_r (rad),azimuth_deg,brdf\n550,0.5235987755982988,0.1,0,0.2\n");
    CHECK(radians.values[0].mu_in == Approx(std::cos(0.5235987755982988)).epsilon(1e-14));
}

TEST_CASE("standard errors find their column, or are said to be unread", "[measured][meaning]") {
    const auto names = GENERATE("reflectance,R_std", "R_mean,R_std", "R,reflectance_sigma",
                                "R,stddev", "mean_R,err");
    CAPTURE(names);
    const Measurements list =
        read_text(std::string("wavelength_nm,") + names + "\n400,0.4,0.002\n500,0.5,0.003\n");
    CHECK(values_of(list) == Doubles{0.4, 0.5});
    CHECK(list.values[1].sigma == 0.003);
    const Measurements orphan = read_text("nm,reflectance,T_std\n400,0.4,0.002\n500,0.5,0.003\n");
    CHECK(std::isnan(orphan.values[0].sigma));
    CHECK_THAT(fact_of(orphan, "columns not read"), Catch::Contains("T_std"));
}

TEST_CASE("lines about the measurement above and below a table are no rows",
          "[measured][meaning]") {
    const auto text = GENERATE(
        "SZA,45\nVZA,0\nwavelength,reflectance\n400,0.4\n500,0.5\n",
        "Wavelength Range: 350,2500\nGPS Time: 15:57:11\nWvl\tReflect. [1.0]\n400\t0.4\n500\t0.5\n",
        "Wavelength,550\nSZA,45\nWave,R\n400,0.4\n500,0.5\n",
        "nm,R\n400,0.4\n500,0.5\nScan rate,600\nDate,12/03/2020\nOperator,A,B\n",
        "Wave;Sample;Reflectance\n[nm];[counts];[%]\n400;812;40\n500;913;50\n");
    CAPTURE(text);
    const Measurements list = read_text(text);
    CHECK(wavelengths_of(list) == Doubles{400, 500});
    CHECK(values_of(list) == Doubles{0.4, 0.5});
}

TEST_CASE("remarks of any mark stand above bare numbers, and JASCO names units above XYDATA",
          "[measured][meaning]") {
    const Measurements bare = read_text(
        "% Date: 2021-03-04\nSZA,45\n// Instrument: Lambda 1050\n400,0.4\n410,0.5\n420,0.6\n");
    CHECK(wavelengths_of(bare) == Doubles{400, 410, 420});
    CHECK_THROWS_WITH(read_text("time,signal\n1,0.4\n2,0.9\n3,0.5\n"),
                      Catch::Contains("no measurements recognised"));
    const Measurements jasco = read_text(
        "TITLE\ts\nORIGIN\tJASCO\nXUNITS\tNANOMETERS\nYUNITS\t%T\nXYDATA\n400\t40\n410\t50\n\n"
        "[Comments]\n");
    CHECK(values_of(jasco) == Doubles{0.4, 0.5});
    CHECK(jasco.values[0].quantity == MeasuredQuantity::transmittance);
}

TEST_CASE("names that say no quantity, and percent that is none, are said", "[measured][meaning]") {
    CHECK_THAT(fact_of(read_text("nm;Dose\n400;0.1\n410;0.2\n"), "columns"),
               Catch::Contains("'Dose' names no quantity"));
    CHECK_THAT(read_text("nm;R (%)\n400;0.4\n410;0.9\n").doubts.at(0),
               Catch::Contains("no value is above 0.9 %"));
    // The standard error of absorbance 1: R ln 10 times that of A.
    const Measurements list = read_text("nm;log(1/R);log(1/R)_std\n400;1;0.01\n410;1;0.02\n");
    REQUIRE(list.values.size() == 2);
    CHECK(list.values[0].sigma == Approx(0.1 * 0.01 * std::log(10.0)).epsilon(1e-12));
}

TEST_CASE("samples of one name stay apart, and what is written is read", "[measured][meaning]") {
    const Measurements rows = read_text("name,400,410,420\nP1,0.1,0.2,0.3\nP1,0.5,0.6,0.7\n");
    CHECK(rows.samples == std::vector<std::string>{"P1", "P1 (2)"});
    MeasuredOptions second;
    second.column = "P1 (2)";
    CHECK(values_of(read_text("name,400,410,420\nP1,0.1,0.2,0.3\nP1,0.5,0.6,0.7\n", second)) ==
          Doubles{0.5, 0.6, 0.7});
    const Measurements again = read_text(
        "quantity,geometry,wavelength_nm,mu_in,mu_out,azimuth_deg,value,sigma,sample\n"
        "reflectance,,400,,,,0.1,,P1\nreflectance,,400,,,,0.5,,P1 (2)\n");
    CHECK(again.samples == rows.samples);
}

TEST_CASE("the quantity chooses between spectrum and Lab, reflectance and transmittance",
          "[measured][meaning]") {
    const std::string both = "wavelength_nm,R,T\n400,0.4,0.3\n500,0.5,0.2\n";
    MeasuredOptions options;
    options.quantity = "plane_transmittance";
    CHECK(values_of(read_text(both, options)) == Doubles{0.3, 0.2});
    options.quantity = "plane_albedo";
    CHECK(values_of(read_text(both, options)) == Doubles{0.4, 0.5});
    options.quantity = "lab";
    CHECK_THROWS_WITH(read_text(both, options), Catch::Contains("reflectance, transmittance"));
    const std::string lab =
        "BEGIN_DATA_FORMAT\nSAMPLE_ID nm400 nm410 nm420 LAB_L LAB_A LAB_B\n"
        "END_DATA_FORMAT\nBEGIN_DATA\n1 0.1 0.2 0.3 50 1 2\nEND_DATA\n";
    CHECK(read_text(lab, options).values.size() == 3);
    CHECK(read_text(lab, options).values[0].quantity == MeasuredQuantity::lab_l);
    options.quantity = "d8-sci";
    CHECK(values_of(read_text(lab, options)) == Doubles{0.1, 0.2, 0.3});
}

TEST_CASE("CGATS files of transmission are transmittance, of emission refused",
          "[measured][meaning]") {
    const auto file = [](const std::string& head) {
        return head +
               "SPECTRAL_NORM \"1.0\"\nBEGIN_DATA_FORMAT\nSPEC_400 SPEC_410 SPEC_420\n"
               "END_DATA_FORMAT\nBEGIN_DATA\n0.1 0.2 0.3\nEND_DATA\n";
    };
    const Measurements list = read_text(file("SPECT\nMEAS_TYPE \"TRANSMISSIVE\"\n"));
    CHECK(list.values[0].quantity == MeasuredQuantity::transmittance);
    const std::string source = GENERATE("MEAS_TYPE \"EMISSION\"\n", "MEAS_TYPE \"AMBIENT\"\n",
                                        "DEVICE_CLASS \"DISPLAY\"\n");
    CHECK_THROWS_WITH(read_text(file("SPECT\n" + source)), Catch::Contains("light of a source"));
}
