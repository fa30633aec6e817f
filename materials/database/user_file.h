// Where the program keeps files of a user: materials, results, the scene of the studio.
#pragma once

#include <filesystem>
#include <string>

namespace miebrdf::materials {

/// $VARIABLE/miebrdf/NAME, else ~/BELOW_HOME/miebrdf/NAME, else in the folder of temporary files.
/// @param variable  of the XDG base directory specification, which asks to ignore relative paths
std::filesystem::path user_file(const char* variable, const char* below_home,
                                const std::string& name);

/// The value of an environment variable; empty where there is none.
std::string from_environment(const char* variable);

}  // namespace miebrdf::materials
