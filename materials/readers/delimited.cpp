#include "materials/readers/delimited.h"

namespace miebrdf::materials {

std::string_view without_blanks(std::string_view text) {
    const char* blanks = " \t\r\n\f\v";
    const auto first = text.find_first_not_of(blanks);
    if (first == std::string_view::npos) return {};
    return text.substr(first, text.find_last_not_of(blanks) - first + 1);
}

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

std::string quoted_field(std::string_view field) {
    if (field.find_first_of(",\"\r\n") == std::string_view::npos) return std::string(field);
    std::string quoted = "\"";
    for (const char c : field) {
        if (c == '"') quoted += '"';
        quoted += c;
    }
    return quoted + '"';
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

}  // namespace miebrdf::materials
