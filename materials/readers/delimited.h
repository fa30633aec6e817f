// Lines of comma-separated fields, quoted where needed (RFC 4180).
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace miebrdf::materials {

/// The fields of one line; a quote inside a quoted field is doubled. Spaces around unquoted fields
/// are dropped.
std::vector<std::string> split_fields(std::string_view line, char separator = ',');

/// Quoted when it has to be.
std::string quoted_field(std::string_view field);

/// The lines of a text, without their ends (LF, CR LF or CR).
std::vector<std::string_view> split_lines(std::string_view text);

std::string_view without_blanks(std::string_view text);

}  // namespace miebrdf::materials
