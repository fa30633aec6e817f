// What the program says to words it does not know: the nearest ones that it does.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace miebrdf::program {

/// "; did you mean brdf or bench?", or nothing when no known word is spelled like it.
std::string did_you_mean(std::string_view asked, const std::vector<std::string>& known);

/// The long names of a command's options without their dashes, those of its groups included.
std::vector<std::string> option_names(const CLI::App& command);

/// What to say of a command line that could not be read. A word that no command knows comes first:
/// what else is missing often follows from it.
std::string explain(const CLI::App& program, const CLI::ParseError& error);

}  // namespace miebrdf::program
