#include "pipeline/formats/common/rgb_source.h"

#include <algorithm>
#include <cmath>

#include <miebrdf/colour.h>
#include <miebrdf/error.h>
#include "pipeline/scene/number_list.h"
#include "tests/support/catch.h"

using namespace miebrdf;

namespace {

bool is_cie(const RgbWeights& weights) {
    return weights.description.find("CIE 1931") != std::string::npos;
}

}  // namespace

TEST_CASE("white stays white in the colours of the CIE observer", "[formats][rgb]") {
    const std::string list = GENERATE("400:700:10", "430:650:20", "360:830:1", "550", "430,650");
    const auto wavelengths = parse_wavelengths_nm(list);
    const RgbWeights weights = rgb_weights("cie", wavelengths);
    REQUIRE(weights.weight.size() == wavelengths.size());
    CAPTURE(list);
    for (std::size_t c = 0; c < 3; ++c) {
        double sum = 0.0;
        for (const auto& weight : weights.weight) sum += weight[c];
        CHECK(std::abs(sum - 1.0) <= 1e-12);  // rounding of a few hundred terms
    }
}

TEST_CASE("spectral lights lie where the gamut of sRGB lets them", "[formats][rgb]") {
    // CIE 15: the spectral locus is outside of every triangle of real primaries, so each line has a
    // negative component; the largest one names its hue.
    const RgbWeights weights = rgb_weights("cie", {460, 510, 530, 620});
    const std::size_t hue[] = {2, 1, 1, 0};
    for (std::size_t w = 0; w < 4; ++w) {
        const auto& weight = weights.weight[w];
        CAPTURE(w, weight[0], weight[1], weight[2]);
        CHECK(std::max_element(weight.begin(), weight.end()) - weight.begin() ==
              std::ptrdiff_t(hue[w]));
        CHECK(*std::min_element(weight.begin(), weight.end()) < 0.0);
    }
}

TEST_CASE("a colour needs eight wavelengths from blue to red, else three stand for it",
          "[formats][rgb]") {
    CHECK(covers_the_visible(parse_wavelengths_nm("430:650:27.5")));      // 9
    CHECK_FALSE(covers_the_visible(parse_wavelengths_nm("430:650:36")));  // 7
    CHECK_FALSE(covers_the_visible(parse_wavelengths_nm("431:651:10")));
    CHECK_FALSE(covers_the_visible(parse_wavelengths_nm("429:649:10")));
    CHECK_FALSE(covers_the_visible({}));

    const auto all = parse_wavelengths_nm("400:700:10");
    CHECK(is_cie(rgb_weights("auto", all)));
    CHECK_FALSE(is_cie(rgb_weights("wavelengths", all)));
    const std::vector<double> few = {450, 500, 540, 600, 650};
    const RgbWeights three = rgb_weights("auto", few);
    CHECK_FALSE(is_cie(three));
    // Nearest to 620, 535 and 480 nm.
    for (std::size_t w = 0; w < few.size(); ++w) {
        CAPTURE(few[w]);
        CHECK(three.weight[w][0] == (few[w] == 600 ? 1.0 : 0.0));
        CHECK(three.weight[w][1] == (few[w] == 540 ? 1.0 : 0.0));
        CHECK(three.weight[w][2] == (few[w] == 500 ? 1.0 : 0.0));
    }
}

TEST_CASE("unknown colours and wavelengths out of order are refused", "[formats][rgb][errors]") {
    CHECK_THROWS_AS(rgb_weights("rgb", {550}), UsageError);
    CHECK_THROWS_WITH(rgb_weights("rgb", {550}),
                      Catch::Contains("'rgb'") && Catch::Contains("cie, wavelengths, auto"));
    for (const std::vector<double>& wrong :
         {std::vector<double>{500, 450}, std::vector<double>{450, 450}}) {
        CHECK_THROWS_AS(rgb_weights("cie", wrong), UsageError);
        CHECK_THROWS_WITH(rgb_weights("cie", wrong), Catch::Contains("ascending"));
    }
}
