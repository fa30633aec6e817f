// A program of subcommands as a function of its arguments, so that a scene file can use it too.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "tools/miebrdf/command.h"

namespace miebrdf::program {

/// Parses and runs one command; errors become one line on standard error and an exit code.
/// @param arguments  without the program's name
/// @param shared  of the run that this command is part of; null: it is the only one
int run_program(std::span<const Command> commands, const std::vector<std::string>& arguments,
                SharedWork* shared = nullptr);

/// Memory that was freed stays with the process. By default glibc gives every matrix above 128 kB
/// back to the system at once and asks for it anew, page by page: 125 thousand page faults and 4 %
/// of the time for 31 wavelengths, more on several threads, which wait for each other there.
void keep_freed_memory();

/// All that main() does: keep_freed_memory() and run_program().
int run_main(std::span<const Command> commands, int argc, char** argv);

/// Adds subcommands to a program, or to a command that has some.
void add_commands(CLI::App& parent, Shell& shell, std::span<const Command> commands);

/// The command line as a shell would read it back: "miebrdf brdf --base TiO2 ...".
std::string command_line_of(const std::vector<std::string>& arguments);

}  // namespace miebrdf::program
