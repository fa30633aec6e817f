#include "materials/readers/text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <miebrdf/database.h>
#include "materials/index/units.h"

namespace miebrdf::materials {
namespace {

constexpr std::pair<std::string_view, std::string_view> kEntities[] = {
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

// "10.1364%2FAO.12.000555" -> "10.1364/AO.12.000555"; printable ASCII only.
std::string without_escapes(std::string_view address) {
    const auto digit = [](char c) {
        if (c >= '0' && c <= '9') return c - '0';
        const char lower = static_cast<char>(c | 0x20);
        return lower >= 'a' && lower <= 'f' ? lower - 'a' + 10 : -1;
    };
    std::string text;
    for (std::size_t i = 0; i < address.size(); ++i) {
        if (address[i] == '%' && i + 2 < address.size()) {
            const int high = digit(address[i + 1]), low = digit(address[i + 2]);
            const int code = high < 0 || low < 0 ? 0 : 16 * high + low;
            if (code > 0x20 && code < 0x7f) {
                text += static_cast<char>(code);
                i += 2;
                continue;
            }
        }
        text += address[i];
    }
    return text;
}

}  // namespace

std::vector<std::string> split_fields(std::string_view line, char separator) {
    std::vector<std::string> fields(1);
    bool quoted = false;
    bool was_quoted = false;
    const auto finish = [&] {
        if (!was_quoted) fields.back() = std::string(without_blanks(fields.back()));
        was_quoted = false;
    };
    for (std::size_t i = 0; i < line.size(); ++i) {
        const char c = line[i];
        if (quoted && c == '"' && i + 1 < line.size() && line[i + 1] == '"') {
            fields.back() += '"';
            ++i;
        } else if (c == '"' && (quoted || without_blanks(fields.back()).empty())) {
            if (!quoted) fields.back().clear();
            quoted = !quoted;
            was_quoted = true;
        } else if (c == separator && !quoted) {
            finish();
            fields.emplace_back();
        } else if (quoted || !was_quoted || (c != ' ' && c != '\r')) {
            fields.back() += c;
        }
    }
    finish();
    return fields;
}

std::vector<std::string_view> split_lines(std::string_view text) {
    std::vector<std::string_view> lines;
    std::size_t start = 0;
    for (std::size_t i = 0; i < text.size(); ++i) {
        if (text[i] != '\n' && text[i] != '\r') continue;
        lines.push_back(text.substr(start, i - start));
        if (text[i] == '\r' && i + 1 < text.size() && text[i + 1] == '\n') ++i;
        start = i + 1;
    }
    if (start < text.size()) lines.push_back(text.substr(start));
    return lines;
}

double require_number(std::string_view text, const std::string& file, int line) {
    const std::optional<double> value = parse_number(text);
    if (!value || !std::isfinite(*value)) {
        throw ImportError(file, line, fmt::format("'{}' is not a number", text.substr(0, 40)));
    }
    return *value;
}

std::vector<std::string_view> split_words(std::string_view line, std::string_view separators) {
    std::vector<std::string_view> words;
    std::size_t start = line.find_first_not_of(separators);
    while (start != std::string_view::npos) {
        const std::size_t end = std::min(line.find_first_of(separators, start), line.size());
        words.push_back(line.substr(start, end - start));
        start = line.find_first_not_of(separators, end);
    }
    return words;
}

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
            for (const auto& [entity, character] : kEntities) {
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

bool is_utf8(std::string_view text) {
    for (std::size_t i = 0; i < text.size();) {
        const auto first = static_cast<unsigned char>(text[i]);
        const std::size_t length = first < 0x80                     ? 1
                                   : first >= 0xc2 && first <= 0xdf ? 2
                                   : first >= 0xe0 && first <= 0xef ? 3
                                   : first >= 0xf0 && first <= 0xf4 ? 4
                                                                    : 0;
        if (length == 0 || i + length > text.size()) return false;
        for (std::size_t j = 1; j < length; ++j) {
            if ((static_cast<unsigned char>(text[i + j]) & 0xc0) != 0x80) return false;
        }
        // Longer than needed, half of a UTF-16 pair, or beyond U+10FFFF.
        const auto second = length > 1 ? static_cast<unsigned char>(text[i + 1]) : 0u;
        if ((first == 0xe0 && second < 0xa0) || (first == 0xed && second > 0x9f) ||
            (first == 0xf0 && second < 0x90) || (first == 0xf4 && second > 0x8f)) {
            return false;
        }
        i += length;
    }
    return true;
}

std::string as_utf8(std::string_view text) {
    if (is_utf8(text)) return std::string(text);
    std::string converted;
    for (const char c : text) {
        const auto byte = static_cast<unsigned char>(c);
        if (byte < 0x80) {
            converted += c;
        } else {
            converted += static_cast<char>(0xc0 | byte >> 6);
            converted += static_cast<char>(0x80 | (byte & 0x3f));
        }
    }
    return converted;
}

std::string shell_quoted(std::string_view text) {
    std::string result = "'";
    for (const char c : text) result += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return result + "'";
}

std::string printable(std::string_view text) {
    std::string clean(text);
    for (std::size_t i = 0; i < clean.size(); ++i) {
        const auto byte = static_cast<unsigned char>(clean[i]);
        // C1, as UTF-8 and as single bytes of no UTF-8.
        const bool is_c1 =
            byte == 0xc2 && i + 1 < clean.size() && static_cast<unsigned char>(clean[i + 1]) < 0xa0;
        if (byte < 0x20 || byte == 0x7f || is_c1) clean[i] = ' ';
        if (is_c1) clean[++i] = ' ';
    }
    return clean;
}

std::string first_doi(std::string_view text) {
    const std::size_t start = text.find("doi.org/10.");
    if (start == std::string_view::npos) return "";
    const std::string_view doi = text.substr(start + 8);
    return without_markup(without_escapes(doi.substr(0, doi.find_first_of("\"'<> \t\r\n"))));
}

}  // namespace miebrdf::materials
