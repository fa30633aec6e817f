#include "materials/readers/markup.h"

#include <utility>

namespace miebrdf::materials {
namespace {

constexpr std::pair<std::string_view, std::string_view> entities[] = {
    {"&amp;", "&"},  {"&lt;", "<"},         {"&gt;", ">"},    {"&quot;", "\""},
    {"&nbsp;", " "}, {"&deg;", "\xc2\xb0"}, {"&ndash;", "-"}, {"&mdash;", "-"},
};

// A '<' starts a tag only before a letter, '/' or '!': "<100>" is a crystal direction.
bool starts_tag(std::string_view html, std::size_t at) {
    if (html[at] != '<' || at + 1 >= html.size()) return false;
    const char next = html[at + 1];
    const bool letter = (next >= 'a' && next <= 'z') || (next >= 'A' && next <= 'Z');
    return (letter || next == '/' || next == '!') && html.find('>', at) != std::string_view::npos;
}

}  // namespace

std::string without_markup(std::string_view html) {
    std::string text;
    bool blank = false;
    const auto append = [&](std::string_view part) {
        if (blank && !text.empty()) text += ' ';
        blank = false;
        text += part;
    };
    for (std::size_t i = 0; i < html.size(); ++i) {
        const char c = html[i];
        if (c == ' ' || c == '\t' || c == '\n' || c == '\r') {
            blank = true;
        } else if (starts_tag(html, i)) {
            const std::size_t end = html.find('>', i);
            if (html.substr(i, 3) == "<br" || html.substr(i, 2) == "<p") blank = true;
            i = end;
        } else if (c == '&') {
            std::string_view value = "&";
            for (const auto& [entity, character] : entities) {
                if (html.substr(i, entity.size()) != entity) continue;
                value = character;
                i += entity.size() - 1;
                break;
            }
            append(value);
        } else {
            append(html.substr(i, 1));
        }
    }
    return text;
}

std::string first_doi(std::string_view text) {
    const std::size_t start = text.find("doi.org/10.");
    if (start == std::string_view::npos) return "";
    const std::string_view doi = text.substr(start + 8);
    return without_markup(doi.substr(0, doi.find_first_of("\"'<> \t\r\n")));
}

}  // namespace miebrdf::materials
