#include "materials/database/names.h"

#include "materials/index/checksum.h"
#include "materials/readers/text.h"
#include "tests/support/catch.h"

using namespace miebrdf::materials;

TEST_CASE("normalised names ignore case, spaces, '_' and '-'", "[materials][names]") {
    CHECK(normalised("Al Ga-As_70") == "algaas70");
    CHECK(normalised("TiO2") == normalised("ti o_2"));
    CHECK(normalised("Al2O3") != normalised("Al2O"));
    CHECK(normalised("TiO\xe2\x82\x82") == "tio2");
}

TEST_CASE("nearest names: beginnings first, then by typing errors", "[materials][names]") {
    const std::vector<std::string> known{"GaP",          "GaAs", "Ge",         "TiO2",
                                         "TiO2_anatase", "SiO2", "polystyrene"};
    CHECK(nearest_names("tio", known).front() == "TiO2");
    CHECK(nearest_names("polystirene", known) == std::vector<std::string>{"polystyrene"});
    CHECK(nearest_names("TOi2", known).front() == "TiO2");
    CHECK(nearest_names("unobtainium", known).empty());
}

TEST_CASE("SHA-256 gives the digests of FIPS 180-4's examples", "[materials][sha256]") {
    CHECK(sha256_hex("") == "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
    CHECK(sha256_hex("abc") == "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
    CHECK(sha256_hex("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq") ==
          "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
    CHECK(sha256_hex(std::string(1000000, 'a')) ==
          "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
}

TEST_CASE("delimited fields: quotes, doubled quotes, blanks", "[materials][delimited]") {
    using Fields = std::vector<std::string>;
    CHECK(split_fields("a, b ,c") == Fields{"a", "b", "c"});
    CHECK(split_fields("\"a, b\",\"say \"\"x\"\"\",") == Fields{"a, b", "say \"x\"", ""});
    CHECK(split_fields("") == Fields{""});
    CHECK(split_lines("a\r\nb\nc\rd").size() == 4);
}
