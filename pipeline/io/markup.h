// Text of users and bytes inside XML and HTML.
#pragma once

#include <string>
#include <string_view>

namespace miebrdf {

/// Text with <, >, & and quotes replaced, and without control characters.
std::string escape_markup(const std::string& text);

/// Bytes as text: RFC 4648, section 4, with padding.
std::string base64(std::string_view bytes);

}  // namespace miebrdf
