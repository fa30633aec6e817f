#include <cstdlib>
#include <filesystem>

#include "materials/database/database.h"

namespace miebrdf::materials {
namespace {

std::filesystem::path from_environment(const char* name) {
    const char* value = std::getenv(name);
    return value == nullptr ? "" : value;
}

}  // namespace

std::filesystem::path default_user_database() {
    if (auto chosen = from_environment("MIEBRDF_DATABASE"); !chosen.empty()) return chosen;
    const auto below = std::filesystem::path("miebrdf") / "materials.sqlite";
    // The XDG base directory specification asks to ignore relative paths.
    if (const auto data = from_environment("XDG_DATA_HOME"); data.is_absolute())
        return data / below;
    const auto home = from_environment("HOME");
    return (home.empty() ? std::filesystem::temp_directory_path() : home / ".local" / "share") /
           below;
}

}  // namespace miebrdf::materials
