// SSDD and ASTM: tables over polar angles.
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "tests/support/catch.h"
#include "tests/support/test_material.h"
#include "tests/support/written_file.h"

using namespace miebrdf;
using support::material;
using support::written_file;

TEST_CASE("ssdd: entries stand in the order of the specification, values are binary floats",
          "[formats][ssdd]") {
    const std::string content = written_file("ssdd", material(), {.resolution = 9});
    CHECK_THAT(content, Catch::StartsWith("VERSION 0."));
    std::size_t last = 0;
    for (const char* entry :
         {"\nDATA_TYPE brdf", "\nCOLOR_MODEL spectrum", "\nWAVELENGTH_LIST 400 450",
          "\nPARAM_TYPE spherical", "\nREDUCTION_TYPE bilateral_symmetry", "\nPARAM0_LIST 0 10",
          "\nPARAM2_LIST 0 10", "\nPARAM3_LIST 0 20", "\nSOURCE_TYPE generated",
          "\nDATA binary\n"}) {
        const std::size_t at = content.find(entry);
        CAPTURE(entry);
        REQUIRE(at != content.npos);
        CHECK(at > last);
        last = at;
    }
    CHECK(content.size() - content.find("DATA binary\n") - 12 == 4 * 7 * 10 * 10 * 10);
}

TEST_CASE("ssdd: figures never begin like a comment, which libbsdf would skip", "[formats][ssdd]") {
    /// Has one value in every direction and at every wavelength.
    class Constant : public support::TestMaterial {
      public:
        explicit Constant(std::uint32_t bits)
            : TestMaterial(support::seven_wavelengths(), 0.4), value_(std::bit_cast<float>(bits)) {}
        void evaluate(std::span<const Direction>, std::span<double> values) const override {
            std::fill(values.begin(), values.end(), value_);
        }

      private:
        float value_;
    };
    // 0.3 or so, its lowest bytes '#'; white space and '#'; a tab and '#'; nothing to avoid.
    const auto bits = GENERATE(0x3e99'9923u, 0x3e99'2320u, 0x3e23'0a09u, 0x3e99'9924u);
    const std::string content = written_file("ssdd", Constant(bits), {.resolution = 9});
    const std::size_t start = content.find("DATA binary\n") + 12;
    CHECK(content[content.find_first_not_of(" \t\n\v\f\r", start)] != '#');
    float first = 0, second = 0;
    std::memcpy(&first, content.data() + start, 4);
    std::memcpy(&second, content.data() + start + 4, 4);
    CHECK(std::abs(first / std::bit_cast<float>(bits) - 1) <= 6e-7);  // at most five units of 2^-23
    CHECK(std::bit_cast<std::uint32_t>(second) == bits);
    CHECK((first == second) == (bits == 0x3e99'9924u));
}

TEST_CASE("astm: the header names angles and wavelengths", "[formats][astm]") {
    CHECK_THAT(written_file("astm", material()),
               Catch::Contains("\nNUM_POINTS 1000\nVARS theta_i,phi_i,theta_s,phi_s,400nm,450nm"));
}

TEST_CASE("angle tables refuse steps out of range", "[formats][ssdd][astm][errors]") {
    CHECK_THROWS_WITH(written_file("ssdd", material(), {.resolution = 2}),
                      Catch::Contains("3 to 180"));
    CHECK_THROWS_AS(written_file("astm", material(), {.resolution = 1000}), UsageError);
}
