// docs/formats/README.md says of each format what the list of formats says.
#include <algorithm>
#include <map>
#include <set>
#include <sstream>

#include <miebrdf/formats.h>
#include "tests/support/catch.h"
#include "tests/support/temporary_folder.h"

using namespace miebrdf;

namespace {

std::string readme() {
    // Beside the reference tables in the sources.
    return support::read_file(MIEBRDF_REFERENCE_DIR "/../../docs/formats/README.md");
}

/// The words between backticks, or between commas.
std::set<std::string> words_of(std::string text) {
    std::replace_if(
        text.begin(), text.end(), [](char c) { return c == '`' || c == ',' || c == '|'; }, ' ');
    std::istringstream in(text);
    return {std::istream_iterator<std::string>(in), {}};
}

/// Options of the program for the fields of ExportOptions whose names differ.
std::string option_of(std::string field) {
    if (field == "azimuth_deg") return "--azimuth";
    if (field == "largest_error") return "--max-error";
    std::replace(field.begin(), field.end(), '_', '-');
    return "--" + field;
}

}  // namespace

TEST_CASE("the page of formats has each of them", "[formats][docs]") {
    const std::string page = readme();
    const std::string table =
        page.substr(page.find("| format | read by |"),
                    page.find("An option that a format") - page.find("| format | read by |"));
    for (const Format& format : all_formats()) {
        CAPTURE(format.name);
        CHECK_THAT(table, Catch::Contains("`" + format.name + "`"));
        CHECK_THAT(table, Catch::Contains(".md)"));
    }
}

TEST_CASE("the page of formats says which options each of them takes", "[formats][docs]") {
    std::map<std::string, std::set<std::string>> taken;
    for (const Format& format : all_formats()) {
        for (const std::string& field : options_of(format))
            taken[option_of(field)].insert(format.name);
    }
    std::istringstream lines(readme());
    std::set<std::string> told;
    for (std::string line; std::getline(lines, line);) {
        if (!line.starts_with("| `--") || line.find("--component") != line.npos) continue;
        const std::size_t column = line.find('|', 1);
        for (const std::string& option : words_of(line.substr(0, column))) {
            CAPTURE(line);
            CHECK(words_of(line.substr(column)) == taken[option]);
            told.insert(option);
        }
    }
    for (const auto& [option, formats] : taken) {
        CAPTURE(option);
        CHECK(told.contains(option));
    }
}
