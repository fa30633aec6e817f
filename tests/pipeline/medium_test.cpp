#include "pipeline/scene/medium.h"

#include <limits>

#include <miebrdf/error.h>
#include "tests/support/catch.h"

using namespace miebrdf;

TEST_CASE("every notation of a medium is read and written back", "[pipeline][medium]") {
    const std::string text = GENERATE("TiO2", "titanium dioxide", "sopra:TIO2", "index:1.5,0.01",
                                      "isotropic:0.9", "rayleigh:1", "hg:0.9,-0.5");
    CHECK(describe(parse_medium(text)) == text);
}

TEST_CASE("only materials and indices go through Mie theory", "[pipeline][medium]") {
    CHECK(needs_mie(parse_medium("TiO2")));
    CHECK(needs_mie(parse_medium("index:1.5,0")));
    CHECK_FALSE(needs_mie(parse_medium("hg:0.9,0.1")));
    CHECK_FALSE(needs_mie(parse_medium("isotropic:0.9")));
}

TEST_CASE("a coat's optical depth is what follows the last @", "[pipeline][medium]") {
    const CoatMedium coat = parse_coat("hg:0.9,0.5@0.1");
    CHECK(coat.optical_depth == 0.1);
    CHECK(describe(coat.medium) == "hg:0.9,0.5");
    CHECK(parse_coat("hg:0.9,0.5@inf").optical_depth == std::numeric_limits<double>::infinity());
}

TEST_CASE("media out of range are refused with the value and the range",
          "[pipeline][medium][errors]") {
    struct Case {
        const char* text;
        const char* value;
        const char* allowed;
    };
    const Case wrong =
        GENERATE(Case{"isotropic:1.2", "1.2", "[0, 1]"}, Case{"hg:0.9,1", "1", "(-1, 1)"},
                 Case{"hg:-0.1,0", "-0.1", "[0, 1]"}, Case{"hg:0.9", "hg:0.9", "hg:ALBEDO,G"},
                 Case{"index:0,1", "0", "n > 0"}, Case{"index:1.5,-1", "-1", "k >= 0"},
                 Case{"index:1.5", "index:1.5", "index:N,K"}, Case{"rayleigh:nan", "nan", "finite"},
                 Case{"isotropic:x", "x", "not a number"});
    CAPTURE(wrong.text);
    CHECK_THROWS_AS(parse_medium(wrong.text), UsageError);
    CHECK_THROWS_WITH(parse_medium(wrong.text),
                      Catch::Contains(wrong.value) && Catch::Contains(wrong.allowed));
}

TEST_CASE("coats without, with negative or with senseless optical depth are refused",
          "[pipeline][medium][errors]") {
    CHECK_THROWS_WITH(parse_coat("TiO2"), Catch::Contains("MEDIUM@OPTICAL_DEPTH"));
    CHECK_THROWS_WITH(parse_coat("TiO2@-1"), Catch::Contains("-1") && Catch::Contains(">= 0"));
    CHECK_THROWS_AS(parse_coat("TiO2@nan"), UsageError);
    CHECK_THROWS_AS(parse_coat("TiO2@-inf"), UsageError);
    CHECK_THROWS_AS(parse_coat("TiO2@1e999"), UsageError);
    CHECK_THROWS_AS(parse_coat("TiO2@"), UsageError);
}
