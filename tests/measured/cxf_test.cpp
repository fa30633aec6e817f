// CxF3.
#include <cmath>

#include "tests/measured/read_text.h"
#include "tests/support/catch.h"

using namespace miebrdf;
using support::read_text;
using Doubles = std::vector<double>;

namespace {

std::string cxf_file(
    const std::string& values, const std::string& geometry,
    const std::string& range = R"(<cc:WavelengthRange StartWL="400" Increment="20"/>)") {
    return R"(<?xml version="1.0"?>
<cc:CxF xmlns:cc="http://colorexchangeformat.com/CxF3-core">
<cc:Resources><cc:ObjectCollection>
<cc:Object ObjectType="Standard" Name="Red 12" Id="o1"><cc:ColorValues>
)" + values +
           R"(
</cc:ColorValues></cc:Object></cc:ObjectCollection>
<cc:ColorSpecificationCollection><cc:ColorSpecification Id="CS1"><cc:TristimulusSpec>
<cc:Illuminant>D50</cc:Illuminant><cc:Observer>2_Degree</cc:Observer></cc:TristimulusSpec>
<cc:MeasurementSpec>
<cc:GeometryChoice>)" +
           geometry + "</cc:GeometryChoice>" + range + R"(
</cc:MeasurementSpec></cc:ColorSpecification></cc:ColorSpecificationCollection>
</cc:Resources></cc:CxF>
)";
}

const std::string kSpectrum =
    R"(<cc:ReflectanceSpectrum ColorSpecification="CS1" StartWL="380">0.1 0.2 0.3</cc:ReflectanceSpectrum>)";

}  // namespace

TEST_CASE("a spectrum of a CxF3 file has its wavelengths and the geometry of its specification",
          "[measured][cxf]") {
    const Measurements sci =
        read_text(cxf_file(kSpectrum, "<cc:SphereGeometry>Specular_Included</cc:SphereGeometry>"),
                  {}, "red.cxf");
    CHECK(sci.format == "cxf");
    CHECK(sci.samples == std::vector<std::string>{"Red 12"});
    CHECK(support::values_of(sci) == Doubles{0.1, 0.2, 0.3});
    CHECK(support::wavelengths_of(sci) == Doubles{380, 400, 420});
    CHECK(sci.values[0].geometry == MeasuredGeometry::d8_sci);
    CHECK(sci.values[0].line == 5);
    CHECK(support::fact_of(sci, "light of CS1") == "D50, 2_Degree");

    const Measurements sce =
        read_text(cxf_file(kSpectrum, "<cc:SphereGeometry>Specular_Excluded</cc:SphereGeometry>"));
    CHECK(sce.values[0].geometry == MeasuredGeometry::d8_sce);

    const Measurements angle = read_text(cxf_file(
        kSpectrum +
            R"(<cc:ColorCIELab ColorSpecification="CS1"><cc:L>50</cc:L><cc:A>40</cc:A><cc:B>-3</cc:B></cc:ColorCIELab>)",
        "<cc:SingleAngle><cc:IlluminationAngle>45.0</cc:IlluminationAngle>"
        "<cc:MeasurementAngle>0.0</cc:MeasurementAngle></cc:SingleAngle>"));
    CHECK(angle.samples.size() == 1);
    CHECK(support::values_of(angle) == Doubles{0.1, 0.2, 0.3, 50, 40, -3});
    CHECK(angle.values[0].geometry == MeasuredGeometry::d45_0);
    CHECK(angle.values[0].quantity == MeasuredQuantity::reflectance_factor);
    CHECK(angle.values[5].quantity == MeasuredQuantity::lab_b);

    const Measurements bare = read_text(cxf_file(kSpectrum, "", ""));
    CHECK(support::wavelengths_of(bare) == Doubles{380, 390, 400});
    REQUIRE(bare.doubts.size() == 1);
    CHECK_THAT(bare.doubts[0], Catch::Contains("taken as 10 nm"));
}

TEST_CASE("damaged CxF3 files are refused with their line", "[measured][cxf][errors]") {
    const std::string whole = cxf_file(kSpectrum, "");
    CHECK_THROWS_WITH(read_text(whole.substr(0, 400)), Catch::Contains("damaged XML"));
    CHECK_THROWS_WITH(
        read_text(cxf_file(
            R"(<cc:ReflectanceSpectrum StartWL="380">0.1 red</cc:ReflectanceSpectrum>)", "")),
        Catch::Contains(":5: 'red'"));
    CHECK_THROWS_WITH(read_text(cxf_file("", "")), Catch::Contains("no reflectance"));
    CHECK_THROWS_WITH(read_text("<cc:CxF xmlns:cc=\"x\"></cc:CxF>"),
                      Catch::Contains("no Resources"));
}
