// A program of subcommands as a function of its arguments, and what it says to words that it does
// not know: the nearest ones that it does.
#pragma once

#include <CLI/CLI.hpp>

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <miebrdf/error.h>
#include "tools/miebrdf/command.h"

namespace miebrdf::program {

/// Parses and runs one command; errors become one line on standard error and an exit code.
/// @param arguments  without the program's name
int run_program(std::span<const Command> commands, const std::vector<std::string>& arguments);

/// The message of an exception in the words of this program: a field of the library becomes the
/// option that sets it ("effective_radius_um" is "--effective-radius (um)").
std::string message_of(const Error& error);

/// Memory that was freed stays with the process. By default glibc gives every matrix above 128 kB
/// back to the system at once and asks for it anew, page by page: 125 thousand page faults and 4 %
/// of the time for 31 wavelengths, more on several threads, which wait for each other there.
void keep_freed_memory();

/// All that main() does: obey_processor_path(), keep_freed_memory() and run_program().
int run_main(std::span<const Command> commands, int argc, char** argv);

/// Adds subcommands to a program, or to a command that has some.
void add_commands(CLI::App& parent, Shell& shell, std::span<const Command> commands);

/// @param read  words of a command line or scene file, of which some are names of files; what
/// stands
///              behind -o is none of them
/// @throws UsageError  for an output that is one of these files
void refuse_to_overwrite(const std::string& output, const std::vector<std::string>& read);

/// The command line as a shell would read it back: "miebrdf brdf --base TiO2 ...".
std::string command_line_of(const std::vector<std::string>& arguments);

/// "; did you mean brdf or bench?", or nothing when no known word is spelled like it.
std::string did_you_mean(std::string_view asked, const std::vector<std::string>& known);

/// The long names of a command's options without their dashes, those of its groups included.
std::vector<std::string> option_names(const CLI::App& command);

/// The message for a command line that could not be read. A word that no command knows comes first:
/// what else is missing often follows from it.
std::string explain(const CLI::App& program, const CLI::ParseError& error);

}  // namespace miebrdf::program
