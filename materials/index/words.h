// Words as people type them.
#pragma once

#include <string>
#include <string_view>

namespace miebrdf::materials {

/// Without blanks and line ends at both ends.
inline std::string_view without_blanks(std::string_view text) {
    const char* blanks = " \t\r\n\f\v";
    const auto first = text.find_first_not_of(blanks);
    if (first == std::string_view::npos) return {};
    return text.substr(first, text.find_last_not_of(blanks) - first + 1);
}

/// Without blanks at its ends and with small ASCII letters.
inline std::string lower_case(std::string_view text) {
    std::string lower(without_blanks(text));
    for (char& c : lower) {
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    }
    return lower;
}

}  // namespace miebrdf::materials
