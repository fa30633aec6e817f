// Binary files of AvaSoft, made here byte by byte.
#include <cstdint>
#include <cstring>

#include "tests/measured/read_text.h"
#include "tests/support/catch.h"

using namespace miebrdf;
using support::read_text;
using support::values_of;
using support::wavelengths_of;
using Doubles = std::vector<double>;

namespace {

template <typename Number>
void add(std::string& bytes, std::initializer_list<Number> numbers) {
    for (const Number number : numbers) {
        char part[sizeof number];
        std::memcpy(part, &number, sizeof number);
        bytes.append(part, sizeof number);
    }
}

/// Pixels 10 to 40, wavelengths 400 + p + p^2 / 64; reference 9, dark 1, sample 1 + 8 p / 64.
std::string avasoft_7(float version, bool whole = true) {
    std::string bytes;
    add(bytes, {version});
    const auto fill = [&](int floats) {
        for (int i = 0; i < floats; ++i) add(bytes, {7.0F});
    };
    if (version == 70.0F) fill(9 + 64);
    add(bytes, {400.0F, 1.0F, 0.015625F, 0.0F, 0.0F});
    if (version == 60.0F) fill(9);
    add(bytes, {10.0F, 40.0F, 2.0F, 0.0F});
    if (version == 70.0F) fill(17);
    for (int p = 10; p <= 40; ++p) {
        add(bytes, {1.0F + 0.125F * float(p)});
        if (whole) add(bytes, {9.0F, 1.0F});
    }
    add(bytes, {150.0F, 10.0F, 0.0F});
    return bytes;
}

/// A spectrum of AvaSoft 8: two channels; the second has a reference as dark as the dark.
std::string avasoft_8(bool is_84, int mode, const std::string& serial) {
    std::string bytes(322, '\0');
    bytes[5] = char(mode);
    bytes.replace(8, serial.size(), serial);
    bytes[83] = 3;  // first and last pixel
    bytes[85] = 4;
    add(bytes, {500.0F, 510.0F, 3.0F, 3.0F, 1.0F, 1.0F, 5.0F, 1.0F});
    if (is_84) bytes.append(3779, '\0');
    const auto size = std::uint32_t(bytes.size());
    std::memcpy(bytes.data(), &size, sizeof size);
    return bytes.append(10, '\0');
}

}  // namespace

TEST_CASE("counts of AvaSoft 6 and 7 are divided by those of the reference, less the dark",
          "[measured][avantes]") {
    const float version = GENERATE(60.0F, 70.0F);
    const Measurements list = read_text(avasoft_7(version), {}, "leaf.TRM");
    CHECK(list.format == "avantes");
    REQUIRE(list.values.size() == 31);
    CHECK(list.values[0].quantity == MeasuredQuantity::transmittance);
    for (int i = 0; i < 31; ++i) {
        const double p = 10 + i;  // binary fractions: exact in floats
        CHECK(list.values[std::size_t(i)].wavelength_nm == 400 + p + p * p / 64);
        CHECK(list.values[std::size_t(i)].value == p / 64);
    }
    CHECK_THROWS_WITH(read_text(avasoft_7(version, false), {}, "leaf.ROH"),
                      Catch::Contains("counts of one spectrum"));
}

TEST_CASE("files of AvaSoft 8 hold spectra of one or several instruments", "[measured][avantes]") {
    const bool is_84 = GENERATE(false, true);
    std::string start = is_84 ? "AVS84" : "AVS82";
    const std::string one = avasoft_8(is_84, 5, "1511108U1"), two = avasoft_8(is_84, 3, "");
    const Measurements list = read_text(start + "\x02" + one + two, {}, "leaf.RFL8");
    CHECK(list.samples == std::vector<std::string>{"1511108U1", "spectrum"});
    CHECK(values_of(list) == Doubles{0.5, 0.5});  // the others have no reference
    CHECK(wavelengths_of(list) == Doubles{500, 500});
    CHECK(list.values[0].quantity == MeasuredQuantity::reflectance);
    CHECK(list.values[1].quantity == MeasuredQuantity::transmittance);
    CHECK_THROWS_WITH(read_text(start + "\x02" + one + two.substr(0, 350)),
                      Catch::Contains("spectrum 2 of 2"));
    CHECK_THROWS_WITH(read_text(start + "\x01" + avasoft_8(is_84, 4, "")),
                      Catch::Contains("irradiance"));
    CHECK_THROWS_WITH(read_text("AVS89" + one), Catch::Contains("AVS89"));
}
