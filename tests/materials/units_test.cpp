#include "materials/index/units.h"

#include <cmath>

#include <miebrdf/error.h>
#include "tests/support/catch.h"

using namespace miebrdf;
using namespace miebrdf::materials;

TEST_CASE("wavelengths are read in every unit people write", "[materials][units]") {
    CHECK(parse_wavelength_nm("550") == 550.0);
    CHECK(parse_wavelength_nm(" 550nm ") == 550.0);
    CHECK(parse_wavelength_nm("0.55um") == Approx(550.0).epsilon(1e-15));
    CHECK(parse_wavelength_nm("0.55 \xc2\xb5m") == Approx(550.0).epsilon(1e-15));
    CHECK(parse_wavelength_nm("5500A") == 550.0);
    // 2 eV is 619.92 nm; 20000 cm-1 is 500 nm; c / 500 THz = 599.584916 nm.
    CHECK(parse_wavelength_nm("2eV") == Approx(619.920992).epsilon(1e-12));
    CHECK(parse_wavelength_nm("20000cm-1") == 500.0);
    CHECK(parse_wavelength_nm("500 THz") == Approx(599.584916).epsilon(1e-15));
    CHECK(parse_wavelength_nm("0.55", Unit::micrometre) == Approx(550.0).epsilon(1e-15));
}

TEST_CASE("nonsense wavelengths are refused with the text in the message",
          "[materials][units][errors]") {
    for (const char* text : {"", "x", "-5", "0", "nan", "inf", "5 parsec", "5e400", "550nm!"}) {
        CAPTURE(text);
        CHECK_THROWS_AS(parse_wavelength_nm(text), UsageError);
        CHECK_THROWS_WITH(parse_wavelength_nm(text),
                          Catch::Contains("'" + std::string(text) + "'"));
    }
}

TEST_CASE("conversion to another unit and back keeps the wavelength to rounding",
          "[materials][units]") {
    for (int i = 0; i < 2000; ++i) {
        const double wavelength_nm = 100.0 * (1.0 + i / 97.0);
        CAPTURE(wavelength_nm);
        CHECK(to_nm(from_nm_exactly(wavelength_nm, Unit::nanometre), Unit::nanometre) ==
              wavelength_nm);
        // Where doubles are coarser in the unit than in nm, half a unit in the last place of the
        // unit remains: a relative 2^-52 at most, plus the rounding of the conversion.
        for (const Unit unit : {Unit::micrometre, Unit::angstrom, Unit::electronvolt,
                                Unit::per_centimetre, Unit::terahertz}) {
            CHECK(std::abs(to_nm(from_nm_exactly(wavelength_nm, unit), unit) / wavelength_nm - 1) <=
                  3.4e-16);
        }
    }
}
