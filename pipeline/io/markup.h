// Text of users inside XML and HTML.
#pragma once

#include <string>

namespace miebrdf {

/// Text with <, >, & and quotes replaced, and without control characters.
std::string escape_markup(const std::string& text);

}  // namespace miebrdf
