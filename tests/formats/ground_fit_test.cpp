// The nearest ground of a model to a BRDF.
#include <miebrdf/brdf.h>
#include <miebrdf/error.h>
#include <miebrdf/formats.h>

#include <cmath>

#include "tests/support/catch.h"

using namespace miebrdf;

TEST_CASE("a ground's BRDF has its own parameters", "[formats][ground]") {
    const std::string words =
        GENERATE("rpv:0.12,0.75,-0.15", "ross-li:0.3,0.1,0.02", "hapke:0.33,0.3,0.4,1.5,0.07,21");
    Scene scene;
    scene.substrate = substrate(words);
    const BrdfTable source = solve(scene, {450, 550}).table();
    const GroundFit fit = fit_ground(source, words.substr(0, words.find(':')));
    REQUIRE(fit.grounds.size() == 2);
    for (std::size_t p = 0; p < fit.parameters.size(); ++p) {
        CAPTURE(words, fit.parameters[p]);
        // The steps end where the sum of squares changes by 1e-10 of itself.
        CHECK(std::abs(fit.grounds[1].values[p] - scene.substrate->brdf.values[p]) <=
              1e-3 * std::max(0.1, std::abs(scene.substrate->brdf.values[p])));
    }
    CHECK(fit.deviation.rms[0] <= 1e-3);
    CHECK(fit.deviation.regions.size() == 7);
}

TEST_CASE("models of more numbers come nearer to a scene", "[formats][ground]") {
    Scene scene;
    scene.base = medium("hg:0.9,0.4");
    const BrdfTable source = solve(scene, {550}).table();
    const auto error_of = [&](const char* model) {
        return fit_ground(source, model).deviation.rms[0];
    };
    const double lambert = error_of("lambert"), rpv = error_of("rpv");
    CHECK(rpv < 0.5 * lambert);
    CHECK(rpv > 1e-3);  // no model is the scene
    CHECK_THROWS_WITH(error_of("phong"), Catch::Contains("phong") && Catch::Contains("hapke"));
}
