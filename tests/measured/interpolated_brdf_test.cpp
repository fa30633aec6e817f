// Measured directions as a BRDF at any direction.
#include <cmath>
#include <numbers>

#include "tests/measured/read_text.h"
#include "tests/support/catch.h"

using namespace miebrdf;

namespace {

/// A reciprocal BRDF with a lobe: Lambert's and a Gaussian about the mirror direction, stronger
/// towards the horizon.
double lobed(const Direction& d) {
    const double sin_in = std::sqrt(1 - d.mu_in * d.mu_in);
    const double sin_out = std::sqrt(1 - d.mu_out * d.mu_out);
    const double azimuth = d.azimuth_deg * std::numbers::pi / 180;
    const double off =
        sin_in * sin_in + sin_out * sin_out - 2 * sin_in * sin_out * std::cos(azimuth);
    return 0.2 + 0.12 * std::exp(-off / 0.3) / (d.mu_in + d.mu_out);
}

Measurements goniometer() {
    Measurements list;
    list.file = "made.csv";
    list.samples = {"made"};
    for (const double theta_in : {0.0, 20.0, 40.0, 60.0}) {
        for (const double theta_out : {10.0, 25.0, 40.0, 55.0, 70.0}) {
            for (const double azimuth : {0.0, 20.0, 50.0, 90.0, 130.0, 180.0}) {
                for (const double nm : {500.0, 600.0}) {
                    const Direction d{std::cos(theta_in * std::numbers::pi / 180),
                                      std::cos(theta_out * std::numbers::pi / 180), azimuth};
                    MeasuredValue v;
                    v.quantity = MeasuredQuantity::brdf;
                    v.geometry = MeasuredGeometry::directions;
                    v.wavelength_nm = nm;
                    v.mu_in = d.mu_in;
                    v.mu_out = d.mu_out;
                    v.azimuth_deg = d.azimuth_deg;
                    v.value = lobed(d) * (nm == 600 ? 0.5 : 1.0);
                    list.values.push_back(v);
                }
            }
        }
    }
    return list;
}

}  // namespace

TEST_CASE("a BRDF between measured directions is reciprocal and near the truth",
          "[measured][interpolated]") {
    const InterpolatedBrdf brdf = interpolated_brdf(goniometer());
    REQUIRE(brdf.source->wavelength_nm() == std::vector<double>{500, 600});
    CHECK(brdf.values == 240);
    CHECK(brdf.residual_rms <= 2e-3);
    CHECK(brdf.leave_one_out_rms <= 0.03);
    CHECK(brdf.least_mu_in == Approx(0.5));
    CHECK_THAT(brdf.source->provenance().accuracy, Catch::Contains("240 measured values"));
    std::vector<double> there(2), back(2), left(2);
    for (const Direction& d : {Direction{0.9, 0.7, 35}, {0.8, 0.6, 150}, {0.6, 0.65, 5}}) {
        brdf.source->evaluate(std::vector<Direction>{d}, there);
        brdf.source->evaluate(std::vector<Direction>{{d.mu_out, d.mu_in, d.azimuth_deg}}, back);
        brdf.source->evaluate(std::vector<Direction>{{d.mu_in, d.mu_out, 360 - d.azimuth_deg}},
                              left);
        CAPTURE(d.mu_in, d.mu_out);
        CHECK(there[0] == Approx(back[0]).epsilon(1e-10));
        CHECK(there[0] == Approx(left[0]).epsilon(1e-10));
        // Twice the error of the values left out.
        CHECK(std::abs(there[0] / lobed(d) - 1) <= 0.06);
        CHECK(there[1] == Approx(0.5 * there[0]).epsilon(0.02));
    }
    // The Lambertian part alone has .2 pi = .63; the lobe adds less than .12 pi / (mu_in + mu_out).
    CHECK(brdf.largest_albedo > 0.63);
    CHECK(brdf.largest_albedo < 1.0);
    CHECK(brdf.doubts.empty());
}

TEST_CASE("measurements that no BRDF can be made of are refused",
          "[measured][interpolated][errors]") {
    const auto refused = [](const Measurements& list, const std::string& with) {
        CHECK_THROWS_WITH(interpolated_brdf(list), Catch::Contains(with));
    };
    Measurements list = goniometer();
    list.values[3].value = -0.1;
    refused(list, "-0.1 at 600 nm");
    list = goniometer();
    list.values[3].azimuth_deg = MeasuredValue::kNone;
    list.values[3].mu_in = 0.5;
    refused(list, "the azimuth");
    list = goniometer();
    list.values.resize(16);
    refused(list, "8 directions");
    list = goniometer();
    list.samples.emplace_back("another");
    refused(list, "2 samples");
    refused(support::read_text("nm,R\n400,0.5\n"), "has no BRDF");
    list = goniometer();
    for (MeasuredValue& v : list.values) v.value *= 3.0;
    CHECK_FALSE(interpolated_brdf(list).doubts.empty());
}
