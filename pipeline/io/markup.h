// Text of users and bytes inside XML and HTML.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace miebrdf {

/// Text with <, >, & and quotes replaced, and without control characters.
std::string escape_markup(const std::string& text);

/// An HTML table of texts that are not escaped yet; the first row is the head.
std::string html_table(const std::vector<std::vector<std::string>>& rows);

/// Bytes as text: RFC 4648, section 4, with padding.
std::string base64(std::string_view bytes);

}  // namespace miebrdf
