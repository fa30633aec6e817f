// Tables of measurements as people, spreadsheets and this program write them.
#include <cmath>
#include <numbers>
#include <set>
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

namespace {}  // namespace

TEST_CASE("a spectrum in columns is read with its quantity, unit and standard error",
          "[measured][csv]") {
    const Measurements list =
        read_text("wavelength_nm,reflectance,sigma\n500,0.4,0.01\n400,0.2,0.02\n600,0.5,0.03\n");
    REQUIRE(list.values.size() == 3);
    CHECK(wavelengths_of(list) == Doubles{400, 500, 600});  // ascending
    CHECK(values_of(list) == Doubles{0.2, 0.4, 0.5});
    CHECK(list.values[0].sigma == 0.02);
    CHECK(list.values[0].line == 3);
    CHECK(list.values[0].quantity == MeasuredQuantity::reflectance);
    CHECK(list.values[0].geometry == MeasuredGeometry::unknown);
    CHECK(std::isnan(list.values[0].mu_in));
    CHECK(list.format == "csv");
    CHECK(list.doubts.empty());
}

TEST_CASE("the same spectrum is read however it is written", "[measured][csv]") {
    const auto text =
        GENERATE("wavelength_nm,reflectance\n400,0.25\n500,0.5\n",        // shares
                 "Wavelength (nm),Reflectance (%)\n400,25\n500,50\n",     // percent in the name
                 "Wellenlänge\nwavelength_um;R\n0,4;0,25\n0,5;0,5\n",     // decimal comma, preamble
                 "\xef\xbb\xbfnm;%R\n400;25,0\n500;50,0\n",               // byte-order mark
                 "wavelength_nm,R\n400,25 %\n500,50 %\n",                 // percent in the field
                 "# reflectance in percent\nlambda,R\n400,25\n500,50\n",  // percent in a remark
                 "wavenumber_cm-1\treflectance\n25000\t0.25\n20000\t0.5\n",  // another unit
                 "Instrument X\nSerial 12\n\nwavelength [nm]\tR [%]\n400\t25\n500\t50\n",
                 "name,400,450,500\npaint,25%,,50%\n",  // in a row
                 "name;400 nm;450 nm;500 nm\npaint;0,25;;0,5\n",
                 "sample,R400,R450,R500\npaint,0.25,NaN,0.5\n");
    const Measurements list = read_text(text);
    CAPTURE(text);
    REQUIRE(list.values.size() == 2);
    CHECK(list.values[0].wavelength_nm == Approx(400).epsilon(1e-14));
    CHECK(list.values[1].wavelength_nm == Approx(500).epsilon(1e-14));
    CHECK(values_of(list) == Doubles{0.25, 0.5});
    CHECK(list.values[0].quantity == MeasuredQuantity::reflectance);
}

TEST_CASE("columns are samples, and the name of a quantity says its geometry", "[measured][csv]") {
    const Measurements many =
        read_text("wavelength_nm,snow A,snow B\n400,0.9,0.8\n500,0.91,0.82\n");
    CHECK(many.samples == std::vector<std::string>{"snow A", "snow B"});
    CHECK(values_of(many) == Doubles{0.9, 0.91, 0.8, 0.82});
    MeasuredOptions one;
    one.column = "Snow B";
    CHECK(values_of(read_text("nm,snow A,snow B\n400,0.9,0.8\n500,0.91,0.82\n", one)) ==
          Doubles{0.8, 0.82});

    const Measurements both = read_text("nm,SCI,SCE\n400,0.5,0.46\n");
    REQUIRE(both.values.size() == 2);
    CHECK(both.values[0].geometry == MeasuredGeometry::d8_sci);
    CHECK(both.values[1].geometry == MeasuredGeometry::d8_sce);
    CHECK(both.values[0].mu_in == Approx(std::cos(8 * std::numbers::pi / 180)));

    const Measurements names = read_text("nm,reflectance,transmittance,index\n400,0.5,0.3,1.4\n");
    REQUIRE(names.values.size() == 2);
    CHECK(names.values[1].quantity == MeasuredQuantity::transmittance);
    CHECK(fact_of(names, "columns not read") == "index");
}

TEST_CASE("rows of samples have the names that stand before the spectra", "[measured][csv]") {
    const Measurements list = read_text(
        "# reflectance in percent\nname\tratio\tseries\t400\t410\t420\n"
        "01A\t100-0-0\tb\t5.09\t5.1\t5.2\n01A\t100-0-0\tw\t80.0\t81.0\t82.0\n");
    CHECK(list.samples == std::vector<std::string>{"01A 100-0-0 b", "01A 100-0-0 w"});
    REQUIRE(list.values.size() == 6);
    CHECK(list.values[0].value == Approx(0.0509).epsilon(1e-14));
    CHECK(list.values[5].value == Approx(0.82).epsilon(1e-14));
    CHECK(list.values[5].wavelength_nm == 420);
    CHECK_FALSE(fact_of(list, "unit").empty());
}

TEST_CASE("spreadsheets end lines with separators and have columns for the mode",
          "[measured][csv]") {
    const Measurements columns = read_text("nm;R;;\n400;0,5;;\n500;0,6;;\n");
    CHECK(values_of(columns) == Doubles{0.5, 0.6});
    const Measurements rows =
        read_text("Name,Mode,400nm,410nm,420nm,\nred,SCI,50%,51%,52%,\nred,SCE,46%,47%,48%,\n");
    CHECK(rows.samples == std::vector<std::string>{"red SCI", "red SCE"});
    REQUIRE(rows.values.size() == 6);
    CHECK(rows.values[0].geometry == MeasuredGeometry::d8_sci);
    CHECK(rows.values[3].geometry == MeasuredGeometry::d8_sce);
    CHECK(rows.values[3].value == Approx(0.46).epsilon(1e-14));
}

TEST_CASE("albedos and measurements that the program writes are read back", "[measured][csv]") {
    const Measurements albedos = read_text(
        "# version: 0\nwavelength_nm,mu_in,plane_albedo,spherical_albedo\n"
        "400,0.5,0.8,0.7\n400,1,0.75,0.7\n500,0.5,0.6,0.5\n500,1,0.55,0.5\n");
    // The spherical albedo, which each mu_in repeats, is there once for each wavelength.
    CHECK(values_of(albedos) == Doubles{0.8, 0.75, 0.6, 0.55, 0.7, 0.5});
    CHECK(albedos.values[0].mu_in == 0.5);
    CHECK(albedos.values[0].geometry == MeasuredGeometry::directional);
    CHECK(albedos.values[4].geometry == MeasuredGeometry::hemispherical);
    CHECK(std::isnan(albedos.values[4].mu_in));

    const Measurements own = read_text(
        "quantity,geometry,wavelength_nm,mu_in,mu_out,azimuth_deg,value,sigma\n"
        "reflectance,d8-sci,400,0.99,,,0.5,0.01\nbrdf,directions,532,0.5,0.25,180,0.3,\n"
        "lab_a,,,,,,-12,\nreflectance_factor,,400,,,,0.5,\n");
    REQUIRE(own.values.size() == 4);
    CHECK(own.values[0].geometry == MeasuredGeometry::d8_sci);
    CHECK(own.values[0].sigma == 0.01);
    CHECK(own.values[1].quantity == MeasuredQuantity::brdf);
    CHECK(own.values[1].azimuth_deg == 180);
    CHECK(std::isnan(own.values[1].sigma));
    CHECK(own.values[2].geometry == MeasuredGeometry::unknown);
    CHECK(own.values[3].quantity == MeasuredQuantity::lab_a);
    CHECK(own.values[3].value == -12);
}

TEST_CASE("options say what a table does not", "[measured][csv]") {
    MeasuredOptions options;
    options.quantity = "plane_albedo";
    options.mu_in = 0.6;
    options.sigma = 0.03;
    options.relative_sigma = 0.1;
    const Measurements list = read_text("400 0.4\n500 0.4\n600 0.4\n", options);
    REQUIRE(list.values.size() == 3);
    CHECK(list.values[0].geometry == MeasuredGeometry::directional);
    CHECK(list.values[0].mu_in == 0.6);
    CHECK(list.values[0].sigma == Approx(0.05).epsilon(1e-14));
    CHECK(list.values[2].wavelength_nm == 600);

    MeasuredOptions percent;
    percent.percent = true;
    CHECK(values_of(read_text("nm,R\n400,80\n", percent)) == Doubles{0.8});
}

TEST_CASE("doubtful tables are read and what may be wrong is said with its line",
          "[measured][csv]") {
    const Measurements list =
        read_text("nm,R\n400,0.5\n410,1.04\n420,-0.01\n430,\n440,0.5\n450,0.6\n600,0.6\n610,0.6\n");
    REQUIRE(list.values.size() == 7);
    REQUIRE(list.doubts.size() == 4);
    CHECK_THAT(list.doubts[0], Catch::Contains("file.csv:5: no number"));
    CHECK_THAT(list.doubts[1], Catch::Contains("file.csv:3: a share above 1"));
    CHECK_THAT(list.doubts[2], Catch::Contains("file.csv:4: a negative value"));
    CHECK_THAT(list.doubts[3], Catch::Contains("nothing between 450 and 600 nm"));
}

TEST_CASE("bad tables are refused with the line and what would help", "[measured][csv][errors]") {
    const auto refused = [](const std::string& text, const std::string& with,
                            const MeasuredOptions& options = {}) {
        CAPTURE(text);
        CHECK_THROWS_WITH(read_text(text, options), Catch::Contains(with));
    };
    refused("wavelength_nm,reflectance\n400,80\n", "file.csv:2: reflectance is 80");
    refused("wavelength_nm,reflectance\n400,80\n", "percent");
    refused("nm,R\n400,0.5\n410,0.5\n400,0.6\n", "400 nm is there twice");
    refused("nm,R\n400,0.5\n410,0.5\n400,0.6\n", "line 2");
    refused("nm,R\n400,bright\n", "file.csv:2: 'bright' in 'R' is not a number");
    refused("nm,R\nblue,0.5\n", "wavelength 'blue'");
    refused("nm,R\n-400,0.5\n", "wavelength -400");
    refused("nm,R\n0.4,0.5\n0.5,0.5\n", "are they micrometres");
    refused("nm,R\n", "no rows");
    refused("nm,R\n400,0.5\n500,0.5,7\n", "file.csv:3: 3 fields");
    refused("nm;R\n400;0,5\n500;0.5\n", "decimal points and decimal commas");
    refused("nm,R\n400,NaN\n", "file.csv:2: no number");
    refused("nm,R,sigma\n400,0.5,-1\n", "sigma -1");
    refused("nothing of interest\n", "no measurements recognised");
    refused("", "is empty");
    refused("quantity,nm,value\nspeed,400,0.5\n", "file.csv:2: quantity: speed");
    refused("geometry,nm,R\naskew,400,0.5\n", "geometry 'askew'");
    MeasuredOptions options;
    options.column = "sooty";
    refused("nm,clean\n400,0.5\n", "column: sooty", options);
    refused("nm,clean\n400,0.5\n", "clean", options);
    options = {};
    options.quantity = "colour";
    refused("nm,R\n400,0.5\n", "plane_albedo", options);
    options = {};
    options.mu_in = 1.5;
    refused("nm,R\n400,0.5\n", "mu_in: 1.5", options);
    options = {};
    options.format = "xlsx";
    refused("nm,R\n400,0.5\n", "format: xlsx", options);
    CHECK_THROWS_AS(read_measured("/nowhere/at-all.csv"), InputError);
}

TEST_CASE("words for quantities lead to their kinds and back", "[measured]") {
    CHECK(measured_kind("d8-sce") ==
          MeasuredKind{MeasuredQuantity::reflectance, MeasuredGeometry::d8_sce});
    CHECK(measured_kind("45-0").quantity == MeasuredQuantity::reflectance_factor);
    CHECK(word_of(MeasuredGeometry::d45_0) == "45-0");
    CHECK(word_of(measured_kind("spherical_transmittance").quantity) == "transmittance");
    CHECK_THROWS_AS(measured_kind("gloss"), UsageError);
}

TEST_CASE("rows of spectra may have directions", "[measured][csv]") {
    const std::string text =
        "theta_i,phi_i,theta_r,phi_r,400nm,500nm,600nm\n"
        "45,0,30,0,0.2,0.3,0.31\n45,0,60,180,0.21,,0.33\n";
    CHECK_THROWS_WITH(read_text(text), Catch::Contains("brdf (1/sr) or reflectance_factor"));
    MeasuredOptions options;
    options.quantity = "brdf";
    const Measurements list = read_text(text, options);
    REQUIRE(list.values.size() == 5);
    CHECK(list.samples.size() <= 1);
    for (const MeasuredValue& value : list.values) {
        CAPTURE(value.value, value.wavelength_nm);
        const bool is_first_row = value.value == 0.2 || value.value == 0.3 || value.value == 0.31;
        const double theta = is_first_row ? 30.0 : 60.0;
        CHECK(value.mu_out == Approx(std::cos(theta * std::numbers::pi / 180.0)));
        CHECK(value.azimuth_deg == Approx(is_first_row ? 180 : 0).margin(1e-9));
        if (value.value == 0.3) CHECK(value.wavelength_nm == 500);
    }
}

TEST_CASE("a value belongs to the column of wavelengths before it, and words may follow the rows",
          "[measured][csv]") {
    const Measurements list = read_text(
        "Sample1,,Baseline,\nWavelength (nm),%R,Wavelength (nm),%R\n"
        "800,45.1,800,99\n799,46.2,798,98\n\nMethod\nScan rate (nm/min) 600\n");
    REQUIRE(list.samples == std::vector<std::string>{"Sample1", "Baseline"});
    REQUIRE(list.values.size() == 4);
    std::set<double> of_baseline;
    for (const MeasuredValue& value : list.values) {
        if (value.sample == 1) of_baseline.insert(value.wavelength_nm);
        CHECK(value.value <= 1.0);
    }
    CHECK(of_baseline == std::set<double>{798, 800});
    CHECK_THROWS_AS(read_text("wavelength_nm,R\n500,0.5\n550\n600,0.55\n"), Error);
}

TEST_CASE("spectra of spreadsheets in German have decimal commas", "[measured][csv]") {
    const Measurements list = read_text(
        "\xef\xbb\xbfWellenl\xc3\xa4nge (nm);Reflexion (%)\n400;45,1\n410;46,2\n420;47,3\n");
    REQUIRE(list.values.size() == 3);
    CHECK(list.values[2].value == Approx(0.473));
    CHECK(list.values[2].quantity == MeasuredQuantity::reflectance);
}
