#include <cmath>
#include <pugixml.hpp>

#include "pipeline/formats/check/check.h"
#include "tests/support/catch.h"
#include "tests/support/sampling.h"
#include "tests/support/test_material.h"
#include "tests/support/written_file.h"

using namespace miebrdf;

TEST_CASE("radiance: the Klems matrix is reciprocal and keeps the albedo", "[formats][radiance]") {
    const support::ColouredMaterial material;
    const std::string content = support::written_file("klems", material.spectral);
    pugi::xml_document document;
    REQUIRE(document.load_string(content.c_str()));
    const auto layer = document.child("WindowElement").child("Optical").child("Layer");
    CHECK(layer.child("Material").child_value("Name") ==
          std::string("half-space of Henyey-Greenstein scatterers"));
    const auto read = read_brdf_file(content, "test");
    const FileCheck check = check_file(*read);
    CAPTURE(*check.reciprocity_rms);
    CHECK(*check.reciprocity_rms <= 0.06);
    // A patch holds the mean over its angles: compare in the middle of one (20 degrees).
    const auto expected = support::integrated_albedo(material.rgb, 0.94);
    const auto found = directional_albedo(*read, 0.94);
    for (std::size_t c = 0; c < 3; ++c) CHECK(std::abs(found[c] / expected[c] - 1) <= 2e-2);
}

TEST_CASE("radiance: levels out of range are refused", "[formats][radiance][errors]") {
    CHECK_THROWS_WITH(support::written_file("radiance", support::material(), {.resolution = 12}),
                      Catch::Contains("2 to 8"));
}
