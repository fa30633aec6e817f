#include "pipeline/scene/number_list.h"

#include <miebrdf/error.h>
#include <miebrdf/scene.h>
#include "tests/support/catch.h"

using namespace miebrdf;
using Numbers = std::vector<double>;

TEST_CASE("lists, ranges and mixtures read as people type them", "[pipeline][number_list]") {
    CHECK(parse_number_list("1,2.5, 3e-2", "x") == Numbers{1, 2.5, 0.03});
    CHECK(parse_number_list("400:700:100", "x") == Numbers{400, 500, 600, 700});
    CHECK(parse_number_list("1:0:-0.5", "x") == Numbers{1, 0.5, 0});
    CHECK(parse_number_list("5,0:2:1,7", "x") == Numbers{5, 0, 1, 2, 7});
    CHECK(parse_number_list("3:3:1", "x") == Numbers{3});
}

TEST_CASE("a range includes its last number although the steps do not meet it exactly",
          "[pipeline][number_list]") {
    // 0.1 + 9 * 0.1 is 1.0000000000000002 or 0.99999999999999989, depending on how it is summed: a
    // cosine just above 1 would be refused.
    const Numbers mu = parse_number_list("0.1:1:0.1", "mu", 0.0, 1.0, true);
    REQUIRE(mu.size() == 10);
    CHECK(mu.back() == 1.0);
    CHECK(mu[2] == 0.3);                                   // not 0.30000000000000004
    CHECK(parse_number_list("0:1:0.3", "x").size() == 4);  // 0.9 is the last one inside
}

TEST_CASE("wavelengths carry units and are converted to nanometres", "[pipeline][number_list]") {
    CHECK(parse_wavelengths_nm("550") == Numbers{550});
    CHECK(parse_wavelengths_nm("550nm,0.55um,5500A")[1] == Approx(550).epsilon(1e-15));
    CHECK(parse_wavelengths_nm("550nm,0.55um,5500A")[2] == Approx(550).epsilon(1e-15));
    // h c = 1239.841984... eV nm: a photon of 2 eV has 619.92 nm.
    CHECK(parse_wavelength_nm("2eV") == Approx(619.920992).epsilon(1e-12));
    CHECK(parse_wavelengths_nm("rgb") == Numbers{620, 535, 480});
    CHECK(parse_wavelengths_nm("0.4um:0.7um:150") == Numbers{400, 550, 700});
}

TEST_CASE("what is no number is refused with the text in the message",
          "[pipeline][number_list][errors]") {
    const std::string bad = GENERATE("", "abc", "1,", "1,,2", "1e", "nan", "inf", "1e999", "1:2",
                                     "1:2:0", "1:2:-1", "1:2:3:4", "0:1:1e-9", "2 3", "0x10");
    CAPTURE(bad);
    CHECK_THROWS_AS(parse_number_list(bad, "mu_in"), UsageError);
    CHECK_THROWS_WITH(parse_number_list(bad, "mu_in"), Catch::Contains("mu_in"));
}

TEST_CASE("a range of wavelengths has even steps in the unit of its step",
          "[pipeline][number_list]") {
    // Photons of 2, 2.5 and 3 eV, h c = 1239.841984 eV nm.
    const auto energies = parse_wavelengths_nm("2eV:3eV:0.5 eV");
    REQUIRE(energies.size() == 3);
    CHECK(energies[0] == Approx(619.920992).epsilon(1e-12));
    CHECK(energies[1] == Approx(495.9367936).epsilon(1e-12));
    CHECK(energies[2] == Approx(413.28066133333333).epsilon(1e-12));
    CHECK(parse_wavelengths_nm("0.4um:0.5um:0.05um").size() == 3);
    CHECK(parse_wavelengths_nm("3eV:2eV:-0.5eV").front() == energies[2]);
    CHECK(parse_wavelengths_nm("0.4um:500:50") == std::vector<double>{400, 450, 500});
}

TEST_CASE("ranges of mixed or impossible units are refused", "[pipeline][number_list][errors]") {
    const auto bad = GENERATE("2:3eV:0.5eV", "400nm:700nm:0.1eV", "2eV:3eV:0.5x", "2eV:3eV:-0.5eV",
                              "-1eV:1eV:0.5eV", "0eV:1eV:0.5eV", "2eV:3eV:eV");
    CAPTURE(bad);
    CHECK_THROWS_AS(parse_wavelengths_nm(bad), UsageError);
}

TEST_CASE("a number out of range is refused with the value and the range",
          "[pipeline][number_list][errors]") {
    CHECK_THROWS_WITH(parse_number_list("0.5,0", "mu", 0.0, 1.0, true),
                      Catch::Contains("0 is out of range") && Catch::Contains("(0, 1]"));
    CHECK_THROWS_WITH(parse_number_list("1.5", "mu", 0.0, 1.0, true), Catch::Contains("1.5"));
    CHECK_THROWS_AS(parse_wavelength_nm("-550"), UsageError);
    CHECK_THROWS_AS(parse_wavelength_nm("0eV"), UsageError);
    CHECK_THROWS_WITH(parse_wavelength_nm("5furlongs"), Catch::Contains("0.55um"));
}

TEST_CASE("what stands in parentheses belongs to a name", "[pipeline][number_list]") {
    CHECK(blank_in_parentheses("a(b,c=1)+d(e(f))") == "a(     )+d(    )");
    // Names of files may have one that does not match.
    CHECK(blank_in_parentheses("mine (1,x=2") == "mine (1,x=2");
    CHECK(blank_in_parentheses("a)(b") == "a)(b");
    const Species formula = species("formula(n=1.5 + 0.01/um^2,k=0),radius=0.2,volume=5%");
    CHECK(formula.name == "formula(n=1.5 + 0.01/um^2,k=0)");
    CHECK(formula.sizes.effective_radius_um == 0.2);
    const Medium mixed =
        medium("formula(n=1 + um,k=0),volume=1% + drude(1,9,0.07),volume=2% in PMMA");
    REQUIRE(mixed.species.size() == 2);
    CHECK(mixed.species[1].name == "drude(1,9,0.07)");
    CHECK(mixed.host->name == "PMMA");
    CHECK(describe(mixed.species[0]) == "formula(n=1 + um,k=0),volume=0.01");
}
