// Words, lines and fields of the texts that readers take apart.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "materials/index/words.h"

namespace miebrdf::materials {

/// The fields of one line; a quote inside a quoted field is doubled. Spaces around unquoted fields
/// are dropped.
std::vector<std::string> split_fields(std::string_view line, char separator = ',');

/// Between single quotes, for any shell.
std::string shell_quoted(std::string_view text);

/// The lines of a text, without their ends (LF, CR LF or CR).
std::vector<std::string_view> split_lines(std::string_view text);

/// A finite number. @throws ImportError
double require_number(std::string_view text, const std::string& file, int line);

/// The words of a line, separated by blanks, tabs, commas or semicolons.
std::vector<std::string_view> split_words(std::string_view line,
                                          std::string_view separators = " \t,;");

/// Tags removed, the common entities resolved, runs of blanks and line ends made one blank.
std::string without_markup(std::string_view html);

bool is_utf8(std::string_view text);
/// The text itself, or, when it is no UTF-8, each byte as a character of Latin-1.
std::string as_utf8(std::string_view text);

/// The text with blanks for control characters, which terminals would obey.
std::string printable(std::string_view text);

/// The first DOI ("10.1103/PhysRevB.6.4370") in a text, or nothing; "%2F" and the like resolved.
std::string first_doi(std::string_view text);

}  // namespace miebrdf::materials
