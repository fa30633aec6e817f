// Provenance as `name: value` lines, the form it has in exported files.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "materials/index/dataset.h"

namespace miebrdf::materials {

/// Begins the comment lines that carry provenance in formats with '#' comments but no such keys.
inline constexpr std::string_view provenance_mark = "# miebrdf ";

/// One line for each thing that is known, without line breaks.
std::vector<std::string> provenance_lines(const Dataset& dataset);

/// Takes over what a line says when it is one of those; other lines are left alone.
void read_provenance_line(Dataset& dataset, std::string_view line);

}  // namespace miebrdf::materials
