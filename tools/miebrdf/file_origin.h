// How a BRDF file says that it was made: the command line in its metadata, and the scene that this
// command asked for.
#pragma once

#include <string>
#include <vector>

#include <miebrdf/brdf.h>
#include "pipeline/scene/scene_words.h"

namespace miebrdf::program {

/// The command line in the metadata of a file that this program wrote, or in FILE.json beside it;
/// empty where there is none. No more of the file is held at once than a block.
/// @throws InputError  when the file cannot be read
std::string command_of_file(const std::string& path);

/// The words of a command line, as a shell reads what command_line_of() writes.
std::vector<std::string> words_of_command(const std::string& command_line);

/// The scene, component and colours that a command line of `export` or `brdf` asks for.
struct SceneOfFile {
    Request request;
    std::string component = "total";
    std::string rgb = "auto";
};

/// Reads them from the metadata. Names of files in the command line are taken as they stand, from
/// the current folder.
/// @throws InputError  when the file does not say how it was made, or by a command that has no
/// scene
SceneOfFile scene_of_file(const std::string& path);

}  // namespace miebrdf::program
