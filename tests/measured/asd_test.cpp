// Binary files of ASD spectrometers, made here byte by byte.
#include <cmath>
#include <cstdint>
#include <cstring>

#include "tests/measured/read_text.h"
#include "tests/support/catch.h"

using namespace miebrdf;
using support::read_text;

namespace {

template <typename Number>
void put(std::string& bytes, std::size_t place, Number number) {
    if (bytes.size() < place + sizeof number) bytes.resize(place + sizeof number);
    std::memcpy(bytes.data() + place, &number, sizeof number);
}

/// Three channels, 350 to 352 nm; the sample's counts over those of the panel are .25, .5, .75.
std::string asd_file(const std::string& version = "as7", char type = 0, char format = 2) {
    std::string bytes(484, '\0');
    bytes.replace(0, 3, version);
    bytes.replace(3, 10, "dry leaves");
    bytes[186] = type;
    put(bytes, 191, 350.0F);
    put(bytes, 195, 1.0F);
    bytes[199] = format;
    put(bytes, 204, std::int16_t{3});
    const double panel[] = {1000, 2000, 4000}, share[] = {0.25, 0.5, 0.75};
    const auto add = [&](double value) {
        if (format == 2) put(bytes, bytes.size(), value);
        if (format == 0) put(bytes, bytes.size(), float(value));
        if (format == 1) put(bytes, bytes.size(), std::int32_t(value));
    };
    for (int i = 0; i < 3; ++i) add(panel[i] * share[i]);
    if (version == "ASD") return bytes;
    bytes.append(18, '\0');
    put(bytes, bytes.size(), std::uint16_t{4});
    bytes += "text";
    for (const double p : panel) add(p);
    return bytes;
}

}  // namespace

TEST_CASE("counts of an ASD file are divided by those of the white panel", "[measured][asd]") {
    const char format = GENERATE(char{0}, char{1}, char{2});
    const char type = GENERATE(char{0}, char{1});
    const Measurements list = read_text(asd_file("as8", type, format), {}, "leaf.asd");
    CHECK(list.format == "asd");
    CHECK(support::values_of(list) == std::vector<double>{0.25, 0.5, 0.75});
    CHECK(support::wavelengths_of(list) == std::vector<double>{350, 351, 352});
    CHECK(list.values[0].quantity == MeasuredQuantity::reflectance_factor);
    CHECK(support::fact_of(list, "comment") == "dry leaves");
}

TEST_CASE("a channel where the panel has no counts is left out and said", "[measured][asd]") {
    std::string bytes = asd_file();
    put(bytes, bytes.size() - 8, 0.0);
    const Measurements list = read_text(bytes);
    CHECK(list.values.size() == 2);
    REQUIRE(list.doubts.size() == 1);
    CHECK_THAT(list.doubts[0], Catch::Contains("no number; left out"));
}

TEST_CASE("damaged ASD files, and those without reflectance, are refused",
          "[measured][asd][errors]") {
    const std::string whole = asd_file();
    for (const std::size_t size : {490ul, 520ul, whole.size() - 1})
        CHECK_THROWS_WITH(read_text(whole.substr(0, size)), Catch::Contains("ends"));
    CHECK_THROWS_WITH(read_text(asd_file("as7", 2)), Catch::Contains("radiance"));
    CHECK_THROWS_WITH(read_text(asd_file("ASD", 0)), Catch::Contains("white panel"));
    std::string damaged = whole;
    put(damaged, 195, -1.0F);
    CHECK_THROWS_WITH(read_text(damaged), Catch::Contains("damaged header"));
    put(damaged, 195, 1.0F);
    put(damaged, 204, std::int16_t{-3});
    CHECK_THROWS_WITH(read_text(damaged), Catch::Contains("-3 channels"));
}
