// iad's files.
#include <cmath>

#include "tests/measured/read_text.h"
#include "tests/support/catch.h"

using namespace miebrdf;
using support::fact_of;
using support::read_text;
using Doubles = std::vector<double>;

namespace {

const std::string kHeader =
    "IAD1  # first\n# a phantom\n1.41 # index\n1.5\n2.65 # mm\n1\n10\n0.98\n1\n"
    "100 20 18 8 0.98\n100 18 0 8 0.98\n";

}  // namespace

TEST_CASE("an rxt file has reflectance and transmittance, by letters or by their number",
          "[measured][rxt]") {
    const auto body = GENERATE("L r t n\n500 0.3 0.35 1.42\n400 0.2 0.25 1.43\n",
                               "Lrtn # together\n500 0.3 0.35 1.42\n400 0.2 0.25 1.43\n",
                               "2\n#lambda M_R M_T\n500 0.3 0.35\n400 0.2 0.25\n",
                               "2 500 0.3 0.35 400 0.2 0.25\n");
    CAPTURE(body);
    const Measurements list = read_text(kHeader + body, {}, "phantom.rxt");
    CHECK(list.samples == std::vector<std::string>{"reflectance", "transmittance"});
    CHECK(support::values_of(list) == Doubles{0.2, 0.3, 0.25, 0.35});
    CHECK(list.values[2].quantity == MeasuredQuantity::transmittance);
    CHECK(list.values[0].geometry == MeasuredGeometry::directional);
    CHECK(fact_of(list, "thickness_mm") == "2.65");
    CHECK(fact_of(list, "slide_index") == "1.5");
    REQUIRE(list.doubts.size() == 2);
    CHECK_THAT(list.doubts[0], Catch::Contains("1 integrating sphere"));
    CHECK_THAT(list.doubts[1], Catch::Contains("angle of incidence"));
    MeasuredOptions options;
    options.mu_in = 0.99;
    const Measurements asked = read_text(kHeader + body, options);
    CHECK(asked.doubts.size() == 1);
    CHECK(asked.values[0].mu_in == 0.99);
}

TEST_CASE("an rxt file may say the angle, and repeat a wavelength for another sample",
          "[measured][rxt]") {
    const Measurements list = read_text(kHeader + "L i r u\n650 60 0.2 0.1\n650 60 0.3 0.1\n");
    REQUIRE(list.values.size() == 4);
    CHECK(list.values[0].mu_in == Approx(0.5));
    CHECK(list.samples == std::vector<std::string>{"reflectance", "unscattered_transmittance",
                                                   "reflectance 2", "unscattered_transmittance 2"});
    CHECK(list.values[1].geometry == MeasuredGeometry::unscattered);
    CHECK(list.doubts.size() == 1);  // of the sphere
}

TEST_CASE("an rxt file says what its spheres are, and what differs between its wavelengths",
          "[measured][rxt]") {
    const Measurements list =
        read_text(kHeader + "L r t w R\n600 0.3 0.1 0.97 0.99\n500 0.3 0.1 0.95 0.97\n");
    REQUIRE(list.spheres);
    CHECK(list.spheres->spheres == 1);
    CHECK(list.spheres->above.detector_port_mm == 8);
    CHECK(list.spheres->below.third_port_mm == 0);
    CHECK(list.spheres->above.standard == 0.98);
    const SphereMeasurement between = list.spheres->at(550);
    CHECK(std::abs(between.above.wall - 0.96) <= 1e-15);
    CHECK(std::abs(between.above.standard - 0.98) <= 1e-15);
    CHECK(between.below.wall == 0.98);
}

TEST_CASE("damaged rxt files are refused with their line", "[measured][rxt][errors]") {
    CHECK_THROWS_WITH(read_text("IAD1\n1.4 1.5\n"), Catch::Contains("ends too early"));
    CHECK_THROWS_WITH(read_text(kHeader), Catch::Contains("ends before its measurements"));
    CHECK_THROWS_WITH(read_text(kHeader + "L r t\n500 0.3\n"), Catch::Contains(":13: the file"));
    CHECK_THROWS_WITH(read_text(kHeader + "L r t\n500 0.3 bright\n"),
                      Catch::Contains(":13: 'bright'"));
    CHECK_THROWS_WITH(read_text(kHeader + "L n z\n500 0.3 1\n"), Catch::Contains("columns 'Lnz'"));
    CHECK_THROWS_WITH(read_text(kHeader + "L r\n500 30\n"), Catch::Contains("percent"));
}
