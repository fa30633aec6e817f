// Scene files: TOML whose keys are the words of a scene and the options of commands
// (docs/scene-files.md).
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "pipeline/scene/request.h"
#include "pipeline/scene/scene_words.h"

namespace miebrdf {

/// A key that a command has besides the words of a scene.
struct CommandKey {
    std::string name;
    WordKind kind = WordKind::single;
};

/// The keys that a command takes from a scene file.
struct SceneFileCommand {
    std::string name;
    std::vector<std::string> words;  ///< of a scene (scene_words)
    std::vector<CommandKey> keys;    ///< all others
    /// Names among these that have no use when the key `format` has this value: what several
    /// results share may hold them. Empty: there are none.
    std::function<std::vector<std::string>(const std::string& format)> useless_for = {};
};

/// A key for the command itself, with the place of its value in the file.
struct SceneFileKey {
    std::string name;
    WordKind kind = WordKind::single;
    std::vector<WordValue> values;  ///< never empty
    std::size_t line = 0, column = 0;
};

/// One [[result]]: what the file, the scene and the result itself say, the later over the earlier.
struct SceneFileResult {
    std::string command;
    Request request;                 ///< from the words of the scene; all else as by default
    std::vector<std::string> words;  ///< those that were said
    std::vector<std::vector<WordValue>> said = {};  ///< their values
    std::vector<SceneFileKey> keys;
    std::string text;  ///< all of it in one line: "albedo base=TiO2 mu-in=0.5,1"
};

/// Reads a whole file; nothing is looked up or computed.
/// @param commands  those that a file may use
/// @throws UsageError  with file, line and column: unknown keys, commands and scenes, values that
/// no
///         scene can have
/// @throws InputError  the same: no TOML, values of the wrong kind
std::vector<SceneFileResult> read_scene_file(const std::string& path,
                                             std::span<const SceneFileCommand> commands);

/// A scene of a file by its name.
struct NamedScene {
    std::string name;
    Request request;
};
/// The scenes that a file names, [scene.NAME], in its order, whatever results it asks for; those of
/// its results, "result 1" and so on, where it names none.
/// @throws UsageError, InputError  as read_scene_file
std::vector<NamedScene> read_named_scenes(const std::string& path,
                                          std::span<const SceneFileCommand> commands);

}  // namespace miebrdf
