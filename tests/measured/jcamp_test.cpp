// JCAMP-DX, plain and packed.
#include <cmath>

#include "tests/measured/read_text.h"
#include "tests/support/catch.h"

using namespace miebrdf;
using support::read_text;
using support::values_of;
using support::wavelengths_of;
using Doubles = std::vector<double>;

namespace {

/// Seven values from 400 to 412 nm, of which `data` has the ordinates in hundredths.
std::string jcamp_file(const std::string& data, const std::string& form = "(X++(Y..Y))",
                       const std::string& units = "REFLECTANCE") {
    return "##TITLE=a powder\n##JCAMP-DX= 4.24 $$ a remark\n##DATA TYPE= UV/VIS SPECTRUM\n"
           "##XUNITS= NANOMETERS\n##Y UNITS= " +
           units +
           "\n##XFACTOR= 1\n##YFACTOR= 0.01\n##FIRSTX= 400\n##LASTX= 412\n##NPOINTS= "
           "7\n##XYDATA= " +
           form + "\n" + data + "##END=\n";
}

}  // namespace

TEST_CASE("the same spectrum is read from plain, squeezed and packed ordinates",
          "[measured][jcamp]") {
    // 10 12 12 12 9 8 -5, in the forms of the standard's table of pseudo-digits.
    const auto data = GENERATE("400 10 12 12 12\n408 9 8 -5\n",  // numbers
                               "400+10+12+12+12\n408+9+8-5\n",   // packed
                               "400A0A2A2A2\n408IHe\n",          // squeezed
                               "400A0K%Tl\n408Ijj3\n",           // differences, checked
                               "400A0A2U\n408IHe\n");            // repeated
    CAPTURE(data);
    const Measurements list = read_text(jcamp_file(data), {}, "powder.jdx");
    CHECK(list.format == "jcamp");
    CHECK(list.samples == std::vector<std::string>{"a powder"});
    CHECK(wavelengths_of(list) == Doubles{400, 402, 404, 406, 408, 410, 412});
    const Doubles expected{0.1, 0.12, 0.12, 0.12, 0.09, 0.08, -0.05};
    REQUIRE(list.values.size() == expected.size());
    for (std::size_t i = 0; i < expected.size(); ++i)
        CHECK(list.values[i].value == Approx(expected[i]).epsilon(1e-14));
}

TEST_CASE("wavenumbers, pairs, percent and absorbance are understood", "[measured][jcamp]") {
    const std::string pairs =
        "##TITLE=b\n##JCAMPDX=4.24\n##XUNITS=1/CM\n##YUNITS=% TRANSMITTANCE\n"
        "##XYPOINTS=(XY..XY)\n20000, 50; 25000, 25\n##END=\n";
    const Measurements list = read_text(pairs);
    CHECK(wavelengths_of(list)[0] == Approx(400).epsilon(1e-14));
    CHECK(values_of(list) == Doubles{0.25, 0.5});
    CHECK(list.values[0].quantity == MeasuredQuantity::transmittance);

    std::string cut = pairs;
    cut.insert(cut.find("##XYPOINTS"), "##NPOINTS=3\n");
    CHECK_THROWS_WITH(read_text(cut), Catch::Contains("cut off"));

    const Measurements dark =
        read_text(jcamp_file("400 100 200 100 100\n408 100 0 100\n", "(X++(Y..Y))", "ABSORBANCE"));
    CHECK(dark.values[1].value == Approx(0.01).epsilon(1e-14));
    CHECK(dark.values[5].value == 1.0);
}

TEST_CASE("damaged JCAMP-DX files are refused with their line", "[measured][jcamp][errors]") {
    const auto refused = [](const std::string& text, const std::string& with) {
        CAPTURE(text);
        CHECK_THROWS_WITH(read_text(text), Catch::Contains(with));
    };
    refused(jcamp_file("400 10 12 12\n"), "3 values; ##NPOINTS= says 7");
    refused(jcamp_file("400 10 12 12 12\n431 9 8 -5\n"), ":13: begins at 431, expected 408");
    refused(jcamp_file("400A0K%Tl\n408Hjj3\n"), "should repeat");
    refused(jcamp_file("400 10 12 && 12\n408 9 8 -5\n"), ":12: '&& 12' is not a packed number");
    refused(jcamp_file("400K\n"), "is not a packed number");
    refused(jcamp_file("400 1\n", "(X++(Y..Y))", "VOLTS"), "##YUNITS= 'VOLTS'");
    refused(jcamp_file("400 1\n", "(R++(I..I))"), "data of the form");
    refused("##TITLE=x\n##JCAMP-DX=4\n##END=\n", "no ##XYDATA=");
    refused("##TITLE=x\n##JCAMP-DX=4\n##XUNITS=HZ\n##XYDATA=(X++(Y..Y))\n1 2\n", "##XUNITS= 'HZ'");
    refused(jcamp_file("400 1000 1200 1200 1200\n408 900 800 -500\n"), "percent");
    refused(jcamp_file("400 10 12 12 12 1 1 1 1\n408 9 8 -5\n"), "more values than ##NPOINTS=");
    refused(jcamp_file("400 1\n", "(X++(Y..Y))", "RADIANCE"), "is radiance");
}

TEST_CASE("the lines, or DELTAX, win over a LASTX that is off, and missing values are said",
          "[measured][jcamp]") {
    const auto file = [](const std::string& labels, const std::string& data) {
        return "##TITLE=t\n##JCAMP-DX=4.24\n##XUNITS=1/CM\n##YUNITS=TRANSMITTANCE\n##YFACTOR=0.01\n"
               "##FIRSTX=1000\n##NPOINTS=9\n" +
               labels + "##XYDATA=(X++(Y..Y))\n" + data + "##END=\n";
    };
    const std::string rows = "1000 10 20 30\n997 40 50 60\n994 50 40 30\n";
    const std::string labels =
        GENERATE("##DELTAX=-1\n##LASTX=990\n", "##LASTX=990\n", "##DELTAX=1.0\n##LASTX=950\n");
    CAPTURE(labels);
    const Measurements list = read_text(file(labels, rows));
    REQUIRE(list.values.size() == 9);
    CHECK(wavelengths_of(list).back() == Approx(1e7 / 992.0).epsilon(1e-12));
    REQUIRE(list.doubts.size() == 1);
    CHECK_THAT(list.doubts[0], Catch::Contains("##LASTX= is 9") && Catch::Contains("say 992"));

    const Measurements one =
        read_text(file("##DELTAX=-1\n##LASTX=990\n", "1000 10 20 30 40 50 60 50 40 30\n"));
    CHECK(wavelengths_of(one).back() == Approx(1e7 / 992.0).epsilon(1e-12));

    const Measurements gap =
        read_text(file("##DELTAX=-1\n##LASTX=992\n", "1000 10 20 ?\n997 40 50 60\n994 50 40 30\n"));
    CHECK(gap.values.size() == 8);
    REQUIRE(gap.doubts.size() == 1);
    CHECK_THAT(gap.doubts[0], Catch::Contains("no number; left out"));
}

TEST_CASE("Kubelka-Munk units and log(1/R) become reflectance", "[measured][jcamp]") {
    // F = (1 - R)^2 / 2R: 0.25 of R = 0.5.
    const Measurements km =
        read_text(jcamp_file("400 25 25 25 25\n408 25 25 25\n", "(X++(Y..Y))", "KUBELKA-MUNK"));
    CHECK(km.values[0].value == Approx(0.5).epsilon(1e-14));
    CHECK(km.values[0].quantity == MeasuredQuantity::reflectance);
    const Measurements log =
        read_text(jcamp_file("400 100 100 100 100\n408 100 100 100\n", "(X++(Y..Y))", "LOG(1/R)"));
    CHECK(log.values[0].value == Approx(0.1).epsilon(1e-14));
    CHECK(log.values[0].quantity == MeasuredQuantity::reflectance);
}
