// The results of a scene file as commands of this program.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "pipeline/scene/scene_file.h"

namespace miebrdf::program {

/// The results of a file, each for a command of this program.
/// @throws UsageError, InputError  with file, line and column
std::vector<SceneFileResult> read_scene_results(const std::string& path);

/// Its scenes by name (read_named_scenes).
/// @throws UsageError, InputError  with file, line and column
std::vector<NamedScene> read_scenes(const std::string& path);

/// Gives the keys of a result to the options of its command and has them read as if they were
/// typed.
/// @throws UsageError  for values that an option does not take, and for one that is missing
void read_keys(const SceneFileResult& result, CLI::App& command);

}  // namespace miebrdf::program
