// The program as a function of its arguments, so that a scene file can use it too.
#pragma once

#include <string>
#include <vector>

#include "pipeline/solve/run_control.h"

namespace miebrdf::program {

/// Parses and runs one command; errors become one line on standard error and an exit code.
/// @param arguments  without the program's name
/// @param shared  of the run that this command is part of; null: it is the only one
int run_program(const std::vector<std::string>& arguments, SharedWork* shared = nullptr);

/// The command line as a shell would read it back: "miebrdf brdf --base TiO2 ...".
std::string command_line_of(const std::vector<std::string>& arguments);

}  // namespace miebrdf::program
