// Scene files as command lines of this program.
#pragma once

#include <string>
#include <vector>

namespace miebrdf::program {

/// One command line for each [[result]] of a scene file, the command's name first.
/// @throws UsageError, InputError  with file, line and column
std::vector<std::vector<std::string>> scene_command_lines(const std::string& path);

}  // namespace miebrdf::program
