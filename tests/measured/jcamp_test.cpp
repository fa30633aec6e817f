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
    refused(jcamp_file("400 10 12 && 12\n408 9 8 -5\n"), ":12: '&& 12' is no packed number");
    refused(jcamp_file("400K\n"), "is no packed number");
    refused(jcamp_file("400 1\n", "(X++(Y..Y))", "VOLTS"), "##YUNITS= 'VOLTS'");
    refused(jcamp_file("400 1\n", "(R++(I..I))"), "data of the form");
    refused("##TITLE=x\n##JCAMP-DX=4\n##END=\n", "no ##XYDATA=");
    refused("##TITLE=x\n##JCAMP-DX=4\n##XUNITS=HZ\n##XYDATA=(X++(Y..Y))\n1 2\n", "##XUNITS= 'HZ'");
    refused(jcamp_file("400 1000 12 12 12\n408 9 8 -5\n"), "percent");
}
