// Scene files: TOML whose keys are the options of the command line (docs/scene-files.md).
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace miebrdf::program {

/// How the program takes an option, as far as a scene file has to know.
enum class OptionKind {
    single,      ///< one value; a list is joined by commas
    repeated,    ///< given once for each value
    flag,        ///< true or false
    positional,  ///< without a name
};

/// Asks whether a command has an option; empty when it has not.
using OptionLookup =
    std::function<std::optional<OptionKind>(const std::string& command, const std::string& option)>;

/// Translates a scene file into command lines, one for each [[result]].
/// @param commands  those a scene file may use
/// @throws InputError  with file, line and column: no TOML, unknown keys, values of the wrong kind
std::vector<std::vector<std::string>> read_scene_file(const std::string& path,
                                                      const std::vector<std::string>& commands,
                                                      const OptionLookup& lookup);

}  // namespace miebrdf::program
