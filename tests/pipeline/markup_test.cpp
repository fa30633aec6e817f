#include "pipeline/io/markup.h"

#include <pugixml.hpp>

#include "tests/support/catch.h"

using namespace miebrdf;

TEST_CASE("text in markup is read back as it was, by an XML parser, in elements and attributes",
          "[pipeline][markup]") {
    const std::string text = "a <b> & \"c\" 'd' &amp; TiO\u2082\n\te";
    const std::string xml = "<t a=\"" + escape_markup(text) + "\" b='" + escape_markup(text) +
                            "'>" + escape_markup(text) + "</t>";
    pugi::xml_document document;
    // As written: XML lets parsers turn line ends and tabs of attributes into blanks.
    REQUIRE(document.load_string(xml.c_str(), pugi::parse_escapes));
    CHECK(document.child("t").child_value() == text);
    CHECK(document.child("t").attribute("a").value() == text);
    CHECK(document.child("t").attribute("b").value() == text);
}

TEST_CASE("control characters, which XML cannot have, are left out", "[pipeline][markup]") {
    CHECK(escape_markup(std::string("a\x01\x1b[31m\0b\r", 10)) == "a[31mb");
}
