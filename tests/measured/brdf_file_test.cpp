// BRDF files that the program exports are measurements, too.
#include <cmath>

#include "tests/measured/read_text.h"
#include "tests/support/catch.h"

using namespace miebrdf;
using support::read_text;

TEST_CASE("a table of a BRDF as JSON gives its listed directions", "[measured][brdf_file]") {
    const Measurements list = read_text(
        R"({"wavelength_nm": [500, 600], "mu_in": [0.5, 1], "mu_out": [0.25], "azimuth_deg": [0, 180],
            "brdf": [[[[0.1, 0.2]], [[0.3, 0.3]]], [[[0.4, 0.5]], [[0.6, 0.6]]]]})",
        {}, "table.json");
    CHECK(list.format == "brdf");
    REQUIRE(list.values.size() == 8);
    CHECK(list.values[0].quantity == MeasuredQuantity::brdf);
    CHECK(list.values[0].wavelength_nm == 500);
    double found = 0.0;
    for (const MeasuredValue& v : list.values) {
        if (v.wavelength_nm == 600 && v.mu_in == 0.5 && v.azimuth_deg == 180) found = v.value;
    }
    CHECK(found == 0.5);
}

TEST_CASE("an angle table of ASTM E1392 is read with its radians and azimuths from the source",
          "[measured][brdf_file]") {
    std::string text = "TITLE made up\nNUM_POINTS 4\nVARS theta_i,phi_i,theta_s,phi_s,532nm\n";
    for (const char* row : {"0.5,0,0.7,0,0.3", "0.5,0,0.7,3.14159265358979,0.5", "1,0,0.7,0,0.2",
                            "1,0,0.7,3.14159265358979,0.6"})
        text += std::string(row) + "\n";
    const Measurements list = read_text(text, {}, "table.astm");
    CHECK(list.format == "brdf");
    double mirror = 0.0;
    for (const MeasuredValue& v : list.values) {
        CHECK(v.wavelength_nm == 532);
        if (std::abs(v.mu_in - std::cos(0.5)) < 1e-6 && v.azimuth_deg == 0.0) mirror = v.value;
    }
    CHECK(mirror == 0.5);
}

TEST_CASE("damaged BRDF files are refused", "[measured][brdf_file][errors]") {
    CHECK_THROWS_AS(read_text(R"({"wavelength_nm": [500]})"), InputError);
    CHECK_THROWS_AS(read_text("{"), InputError);
}
