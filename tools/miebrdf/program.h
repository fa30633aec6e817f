// The program as a function of its arguments, so that a scene file can use it too.
#pragma once

#include <string>
#include <vector>

namespace miebrdf::program {

/// Parses and runs one command; errors become one line on standard error and an exit code.
/// @param arguments  without the program's name
int run_program(const std::vector<std::string>& arguments);

/// The command line as a shell would read it back: "miebrdf brdf --base TiO2 ...".
std::string command_line_of(const std::vector<std::string>& arguments);

}  // namespace miebrdf::program
