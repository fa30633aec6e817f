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

/// The commands that a scene file may use, and what it may say to them.
struct SceneCommands {
    std::vector<std::string> names;
    /// Whether a command has an option; empty when it has not.
    std::function<std::optional<OptionKind>(const std::string& command, const std::string& option)>
        kind_of;
    std::function<std::vector<std::string>(const std::string& command)> options_of;
    /// Options that `format` of a command has no use for: what is shared with other results may
    /// hold them, the result itself may not.
    std::function<std::vector<std::string>(const std::string& command, const std::string& format)>
        useless_for;
};

/// Translates a scene file into command lines, one for each [[result]].
/// @throws UsageError  with file, line and column: unknown keys, commands and scenes
/// @throws InputError  the same: no TOML, values of the wrong kind
std::vector<std::vector<std::string>> read_scene_file(const std::string& path,
                                                      const SceneCommands& commands);

}  // namespace miebrdf::program
