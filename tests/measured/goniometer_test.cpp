// Lists of directions: signs, azimuths and their conventions.
#include <cmath>
#include <numbers>

#include "tests/measured/read_text.h"
#include "tests/support/catch.h"

using namespace miebrdf;
using support::fact_of;
using support::read_text;

namespace {

double theta_of(double mu) { return std::acos(mu) * 180.0 / std::numbers::pi; }

/// Azimuths of the values, rounded to whole degrees.
std::vector<int> azimuths(const Measurements& list) {
    std::vector<int> all;
    for (const MeasuredValue& v : list.values) all.push_back(int(std::lround(v.azimuth_deg)));
    return all;
}

}  // namespace

TEST_CASE("two azimuths are coordinates: equal ones point back to the source",
          "[measured][goniometer]") {
    const Measurements list = read_text(
        "theta_i,phi_i,theta_r,phi_r,wavelength_nm,brdf\n"
        "30,10,40,10,532,0.3\n30,10,40,190,532,0.4\n30,10,40,100,532,0.5\n");
    CHECK(azimuths(list) == std::vector<int>{180, 0, 90});
    CHECK(theta_of(list.values[0].mu_in) == Approx(30));
    CHECK(theta_of(list.values[0].mu_out) == Approx(40));
    CHECK(list.values[0].quantity == MeasuredQuantity::brdf);
    CHECK(list.values[0].geometry == MeasuredGeometry::directions);
    CHECK_THAT(fact_of(list, "azimuth"), Catch::Contains("coordinates"));
}

TEST_CASE("a negative theta_in turns the incident direction round", "[measured][goniometer]") {
    const Measurements list = read_text(
        "wavelength_nm,theta_in_deg,theta_out_deg,phi_out_deg,brdf\n"
        "532,-30,30,0,0.9\n532,-30,30,180,0.3\n532,-30,-30,180,0.9\n");
    CHECK(azimuths(list) == std::vector<int>{0, 180, 0});
}

TEST_CASE("one azimuth means what is asked for, what the program means, or what a lobe shows",
          "[measured][goniometer]") {
    const std::string dull =
        "theta_i,theta_r,phi,wavelength_nm,brdf\n45,45,0,550,0.30\n45,45,180,550,0.32\n";
    CHECK_THROWS_WITH(read_text(dull),
                      Catch::Contains("what is azimuth 0") && Catch::Contains("mirror or back"));
    MeasuredOptions options;
    options.azimuth_zero = "mirror";
    CHECK(azimuths(read_text(dull, options)) == std::vector<int>{0, 180});
    options.azimuth_zero = "back";
    CHECK(azimuths(read_text(dull, options)) == std::vector<int>{180, 0});
    options.azimuth_zero = "left";
    CHECK_THROWS_AS(read_text(dull, options), UsageError);

    const Measurements ours =
        read_text("theta_in,theta_out,azimuth_deg,wavelength_nm,brdf\n45,45,30,550,0.30\n");
    CHECK(azimuths(ours) == std::vector<int>{30});

    const Measurements front =
        read_text("theta_i,theta_r,phi,nm,brdf\n45,45,0,550,3.0\n45,45,180,550,0.32\n");
    CHECK(azimuths(front) == std::vector<int>{0, 180});
    CHECK_THAT(fact_of(front, "azimuth"), Catch::Contains("mirror side"));
    const Measurements back =
        read_text("theta_i,theta_r,phi,nm,brdf\n45,45,0,550,0.30\n45,45,180,550,3.2\n");
    CHECK(azimuths(back) == std::vector<int>{180, 0});
}

TEST_CASE("directions go by the names of laboratories and of remote sensing",
          "[measured][goniometer]") {
    for (const std::string names :
         {"theta_i,phi_i,theta_r,phi_r", "thetai,phii,thetar,phir", "thetai,phi,thetar,phir",
          "SZA,SAA,VZA,VAA", "incident zenith,incident azimuth,view zenith,view azimuth",
          "Theta_in [deg],Phi_in [deg],Theta_out [deg],Phi_out [deg]",
          "solar_zenith_angle,solar_azimuth_angle,sensor_zenith_angle,sensor_azimuth_angle",
          "theta_source,phi_source,theta_detector,phi_detector"}) {
        CAPTURE(names);
        const Measurements list =
            read_text(names + ",wavelength_nm,f_r11\n30,10,40,10,532,0.3\n30,10,40,100,532,0.5\n");
        REQUIRE(list.values.size() == 2);
        CHECK(azimuths(list) == std::vector<int>{180, 90});
        CHECK(theta_of(list.values[0].mu_in) == Approx(30));
        CHECK(theta_of(list.values[0].mu_out) == Approx(40));
        CHECK(list.values[0].quantity == MeasuredQuantity::brdf);
    }
    const Measurements cosines =
        read_text("cos_theta_i,cos_theta_r,azimuth_deg,nm,brdf\n0.5,0.25,90,550,0.3\n");
    CHECK(cosines.values[0].mu_in == 0.5);
    CHECK(cosines.values[0].mu_out == 0.25);
    // Rusinkiewicz's angles, and the angle between two directions, are others.
    for (const std::string names : {"theta_h,theta_d", "theta_i,scattering_angle"}) {
        CAPTURE(names);
        const Measurements list = read_text(names + ",nm,brdf\n10,20,550,0.3\n");
        CHECK(std::isnan(list.values[0].mu_out));
    }
}

TEST_CASE("signs of theta_out are the two sides of a plane", "[measured][goniometer]") {
    MeasuredOptions options;
    options.azimuth_zero = "mirror";
    options.wavelength_nm = 633;
    const Measurements list = read_text(
        "theta_in,theta_out,brdf\n30,-60,0.2\n30,-30,0.21\n30,0,0.22\n30,60,0.3\n", options);
    CHECK(azimuths(list) == std::vector<int>{180, 180, 0, 0});
    CHECK(list.values[0].wavelength_nm == 633);
    CHECK(theta_of(list.values[0].mu_out) == Approx(60));
}

TEST_CASE("radians and a BRDF times the cosine are converted", "[measured][goniometer]") {
    MeasuredOptions options;
    options.azimuth_zero = "mirror";
    const Measurements list = read_text(
        "theta_i (rad),theta_r (rad),phi "
        "(rad),nm,brdf_cos\n0.5,1.0471975511965976,3.14159265358979,500,0.1\n",
        options);
    REQUIRE(list.values.size() == 1);
    CHECK(theta_of(list.values[0].mu_out) == Approx(60));
    CHECK(list.values[0].azimuth_deg == Approx(180));
    CHECK(list.values[0].value == Approx(0.2));
}

TEST_CASE("lists of directions that say too little or too much are refused",
          "[measured][goniometer][errors]") {
    CHECK_THROWS_WITH(read_text("theta_i,theta_r,phi,nm,signal\n30,40,0,500,0.3\n"),
                      Catch::Contains("numbers of a detector"));
    CHECK_THROWS_WITH(read_text("theta_i,theta_r,nm,brdf\n30,95,500,0.3\n"),
                      Catch::Contains("file.csv:2: theta_out 95"));
    CHECK_THROWS_WITH(read_text("theta_i,theta_r,nm,brdf\n30,,500,0.3\n"),
                      Catch::Contains("'theta_r' has no number"));
    CHECK_THROWS_WITH(read_text("mu_in,mu_out,azimuth_deg,nm,brdf\n30,0.5,0,500,0.3\n"),
                      Catch::Contains("cosine 30"));
}
